/* One of everything that the firmware library must not contain: what check_archive.py has to find. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

int planted_counter(void);
int planted_counter(void)
{
    static int calls;
    return ++calls;
}

void *planted_heap(size_t size);
void *planted_heap(size_t size) { return malloc(size); }

void planted_stdio(int n);
void planted_stdio(int n) { printf("%d %d\n", n, n); }

#ifndef __AVR__
double planted_double(double a, float b);
double planted_double(double a, float b) { return a * b + 0.1; }
#endif

int planted_external(const char *name);
int planted_external(const char *name) { return system(name); }

/* calls itself */
int planted_tree(const int *left, const int *right, int node);
__attribute__((noinline)) int planted_tree(const int *left, const int *right, int node)
{
    return node < 0 ? 0 : 1 + planted_tree(left, right, left[node]) * planted_tree(left, right, right[node]);
}

/* two that call each other, one of them local to this file */
int planted_ping(int n);
static __attribute__((noinline, noclone)) int planted_pong(int n) { return n < 0 ? 1 : planted_ping(n - 3) + 1; }
__attribute__((noinline, noclone)) int planted_ping(int n) { return n < 0 ? 2 : planted_pong(n - 1) * 3; }
