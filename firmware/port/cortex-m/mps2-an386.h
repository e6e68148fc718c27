/* Arm MPS2, application note AN386. */
#define PORT_HZ 25000000u
#define UART_BASE 0x40004000u
#define UART_INTERRUPT 0
