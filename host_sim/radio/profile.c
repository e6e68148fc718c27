#include "radio/profile.h"

#include <math.h>
#include <string.h>

#define SYMBOL_US 16.0 /* IEEE 802.15.4-2006, 6.5.3.2: 62.5 ksymbol/s at 2.4 GHz */
#define BYTE_US (8e6 / 19200)

static const struct radio_profile profiles[] = {
    {
        .name = "ideal",
        .bitrate_bps = 250000,
        .preamble_bytes = 6, /* as 802154, from here on */
        .sensitivity_dbm = -95,
    },
    /* Names in brackets and section numbers: IEEE Std 802.15.4-2006, 2.4 GHz O-QPSK. Chip: CC2420 data sheet (SWRS041). */
    {
        .name = "802154",
        .contention = true,
        .bitrate_bps = 250000,
        .preamble_bytes = 6,                  /* 6.3: 4 preamble, 1 start of frame, 1 length */
        .header_bytes = 9,                    /* 7.2.1: 2 control, 1 number, 2 network, 2 + 2 addresses */
        .ack_bytes = 11,                      /* 7.2.2.3: 6 + 2 control, 1 number, 2 check sum */
        .backoff_unit_us = 20 * SYMBOL_US,    /* [aUnitBackoffPeriod] */
        .backoff_exponents = {3, 4, 5, 5, 5}, /* [macMinBE] 3, [macMaxBE] 5 */
        .backoffs = 4,                        /* [macMaxCSMABackoffs] */
        .cca_us = 8 * SYMBOL_US,              /* 6.9.9 */
        .turnaround_us = 12 * SYMBOL_US,      /* [aTurnaroundTime] */
        .ack_turnaround_us = 12 * SYMBOL_US,  /* 7.5.6.4.2 */
        .ack_wait_us = 54 * SYMBOL_US,        /* [macAckWaitDuration] */
        .retries = 3,                         /* [macMaxFrameRetries] */
        .sensitivity_dbm = -95,               /* CC2420, typical */
        .noise_margin_db = 5,                 /* CC2420 reads about -100 dBm on a silent channel */
        .capture_db = 3,                      /* CC2420: co-channel rejection -3 dB; Gezer, Buratti and Verdone, 2010 */
        .cca_threshold_db = 10,               /* 6.9.9: energy at most 10 dB above the sensitivity is seen */
    },
    /* Mica2. Carrier sense: TinyOS's CC1000CsmaP and CC1000SendReceiveP; times: Polastre, Hill and Culler, "Versatile low power media access
     * for wireless sensor networks" (B-MAC), SenSys 2004. */
    {
        .name = "cc1000",
        .contention = true,
        .bitrate_bps = 19200, /* 38.4 kbaud Manchester */
        .preamble_bytes = 10, /* B-MAC: 8 preamble, 2 synchronisation */
        .header_bytes = 5,    /* TOS_Msg: 2 address, type, group, length */
        .ack_bytes = 16,      /* CC1000SendReceiveP: ACK_LENGTH, the code at its end */
        .backoff_unit_us = BYTE_US,
        .least_units = 1,
        .backoff_exponents = {5, 4, 4, 4, 4}, /* CC1000CsmaP: initially 1 ... 32 bytes, congestion 1 ... 16 */
        .backoffs = 1u << 30,                 /* CC1000CsmaP never gives up */
        .cca_us = 350,                        /* B-MAC: to sample the radio */
        .turnaround_us = 250,                 /* B-MAC: to switch between receiving and transmitting */
        .ack_turnaround_us = 250,
        .ack_wait_us = 24 * BYTE_US, /* CC1000SendReceiveP: 3 flush, 3 turn, then MAX_ACK_WAIT 18 */
        .retries = 0,                /* left to the layer above */
        .sensitivity_dbm = -98,      /* Crossbow, Mica2 data sheet */
        .noise_margin_db = 7,        /* noise -105 dBm: Zuniga and Krishnamachari, SECON 2004 */
        .capture_db = 5,             /* 3 to 6 dB: Son, Krishnamachari and Heidemann, SenSys 2006 */
        .cca_threshold_db = 0,
    },
};

unsigned radio_profile_air_us(const struct radio_profile *profile, size_t bytes)
{
    return (unsigned)lround(8e6 * (double)bytes / profile->bitrate_bps);
}

const struct radio_profile *radio_profile_find(const char *name)
{
    for (size_t i = 0; i < sizeof profiles / sizeof profiles[0]; i++) {
        if (strcmp(profiles[i].name, name) == 0) {
            return &profiles[i];
        }
    }
    return NULL;
}
