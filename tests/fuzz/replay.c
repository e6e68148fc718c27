/* Calls a fuzzer without libFuzzer: with every file of the folders named, cut off at every length, and with every byte changed. */
#include "fuzz.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>

enum { INPUT_MAX = 1 << 16, VARIANTS_MAX = 400 };

static int replay(const char *path)
{
    static uint8_t input[INPUT_MAX];
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        perror(path);
        return -1;
    }
    const size_t size = fread(input, 1, sizeof input, file);
    fclose(file);
    LLVMFuzzerTestOneInput(input, size);
    const size_t stride = 1 + size / VARIANTS_MAX;
    for (size_t i = 0; i < size; i += stride) {
        LLVMFuzzerTestOneInput(input, i);
        input[i] ^= (uint8_t)(1u << i % 8);
        LLVMFuzzerTestOneInput(input, size);
        input[i] ^= (uint8_t)(1u << i % 8);
    }
    return 0;
}

int main(int argc, char **argv)
{
    int files = 0;
    for (int i = 1; i < argc; i++) {
        DIR *folder = opendir(argv[i]);
        if (folder == NULL) {
            perror(argv[i]);
            return 1;
        }
        for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
            char path[4096];
            if (entry->d_name[0] == '.') {
                continue;
            }
            snprintf(path, sizeof path, "%s/%s", argv[i], entry->d_name);
            if (replay(path) != 0) {
                return 1;
            }
            files++;
        }
        closedir(folder);
    }
    printf("%d inputs, each whole, cut off and changed\n", files);
    return files > 0 ? 0 : 1;
}
