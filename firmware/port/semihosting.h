/* Console and exit through semihosting (Arm, "Semihosting for AArch32 and AArch64"; RISC-V has the same operations).
 *
 * A port declares semihost(operation, argument), its processor's call to the host, and includes this once. */
#ifndef SEMIHOSTING_H
#define SEMIHOSTING_H

enum { SYS_WRITEC = 0x03, SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20 };
#define APPLICATION_EXIT 0x20026u /* ADP_Stopped_ApplicationExit */

void port_putc(int c)
{
    char character = (char)c;
    semihost(SYS_WRITEC, &character);
}

void port_puts(const char *s) { semihost(SYS_WRITE0, s); }

void port_exit(int status)
{
    const uint32_t block[2] = {APPLICATION_EXIT, (uint32_t)status};
    semihost(SYS_EXIT_EXTENDED, block);
    for (;;) {}
}

#endif
