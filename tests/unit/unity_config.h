#ifndef UNITY_CONFIG_H
#define UNITY_CONFIG_H
#define UNITY_OUTPUT_CHAR(c) port_putc(c)
#define UNITY_OUTPUT_CHAR_HEADER_DECLARATION port_putc(int)
#define UNITY_EXCLUDE_DOUBLE
#define UNITY_SUPPORT_64
#endif
