/* Arm MPS2, application note AN505, seen from the secure side. */
#define PORT_HZ 20000000u
#define UART_BASE 0x50200000u
#define UART_INTERRUPT 32
