#ifndef PORT_H
#define PORT_H
#include <stdint.h>
void port_putc(int c);
void port_puts(const char *s);
void port_exit(int code);               /* never returns */
uint32_t port_count_start(void);        /* raw counter, see port_count_stop */
uint32_t port_count_stop(uint32_t t0);  /* instructions (QEMU -icount) since t0 */
#endif
