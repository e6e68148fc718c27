/* A plugin for QEMU (TCG plugins, API version 1) that counts the instructions of every call of one function.
 *
 *   qemu-system-... -plugin file=./qcount.so,name=NAME,start=ADDRESS,stop=ADDRESS
 *
 * Counting begins with the instruction at `start` and ends before the one at `stop`. A line
 * "NAME calls=N min=N max=N mean=N" on standard error tells the counts when the emulator ends. The declarations below are those
 * of qemu-plugin.h, which Debian does not package. */
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
enum { QEMU_PLUGIN_CB_NO_REGS = 0 };
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*callback)(qemu_plugin_id_t, struct qemu_plugin_tb *));
void qemu_plugin_register_vcpu_tb_exec_cb(struct qemu_plugin_tb *tb, void (*callback)(unsigned int, void *), int flags,
                                          void *userdata);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id, void (*callback)(qemu_plugin_id_t, void *), void *userdata);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *tb);
uint64_t qemu_plugin_tb_vaddr(const struct qemu_plugin_tb *tb);

EXPORT int qemu_plugin_version = 1;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int argc, char **argv);

static struct {
    const char *name;
    uint64_t start, stop;
    int inside;
    uint64_t instructions, calls, total, min, max;
} count = {.name = "function"};

/* QEMU translates block by block: what is between two jumps. Whoever calls a function begins a block. */
struct block {
    uint64_t address, instructions;
};

static void executed(unsigned int cpu, void *userdata)
{
    (void)cpu;
    const struct block *block = userdata;
    const uint64_t address = block->address;
    if (count.inside && address == count.stop) {
        count.inside = 0;
        count.min = count.calls == 0 || count.instructions < count.min ? count.instructions : count.min;
        count.max = count.instructions > count.max ? count.instructions : count.max;
        count.total += count.instructions;
        count.calls++;
    }
    if (!count.inside && address == count.start) {
        count.inside = 1;
        count.instructions = 0;
    }
    count.instructions += count.inside ? block->instructions : 0;
}

static void translated(qemu_plugin_id_t id, struct qemu_plugin_tb *tb)
{
    (void)id;
    struct block *block = malloc(sizeof *block); /* kept: the block may be executed until the end */
    if (block == NULL) {
        abort();
    }
    block->address = qemu_plugin_tb_vaddr(tb);
    block->instructions = qemu_plugin_tb_n_insns(tb);
    qemu_plugin_register_vcpu_tb_exec_cb(tb, executed, QEMU_PLUGIN_CB_NO_REGS, block);
}

static void tell(qemu_plugin_id_t id, void *userdata)
{
    (void)id;
    (void)userdata;
    fprintf(stderr, "%s calls=%" PRIu64 " min=%" PRIu64 " max=%" PRIu64 " mean=%.1f\n", count.name, count.calls,
            count.min, count.max, count.calls > 0 ? (double)count.total / (double)count.calls : 0.0);
}

int qemu_plugin_install(qemu_plugin_id_t id, const void *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        if (strncmp(argv[i], "name=", 5) == 0) {
            count.name = strdup(argv[i] + 5);
        } else if (strncmp(argv[i], "start=", 6) == 0) {
            count.start = strtoull(argv[i] + 6, NULL, 0);
        } else if (strncmp(argv[i], "stop=", 5) == 0) {
            count.stop = strtoull(argv[i] + 5, NULL, 0);
        }
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
    qemu_plugin_register_atexit_cb(id, tell, NULL);
    return 0;
}
