/* nRF51822 (nRF51 Series Reference Manual): numbers of interrupts, pins of the micro:bit. */
#define PORT_HZ 16000000u
#define UART_INTERRUPT 2
#define TIMER_INTERRUPT 8
#define UART_TX_PIN 24
#define UART_RX_PIN 25
