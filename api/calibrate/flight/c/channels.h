/*
 * Sun direction of a calibrated Sun sensor of several channels. Written by sunatlas calibrate.
%said%
 *
 * Frame: +z is the boresight; the result is the unit vector from the sensor to the Sun.
 * Signals: readings less dark, over gain, in the order of the calibration's columns.
 * Flash: about %flash% bytes of constants and code. Stack: below 512 bytes. No memory is
 * allocated and nothing is kept between calls. Operations: about %operations% multiplications and
 * two square roots, whatever the reading.
 */
#ifndef %NAME%_H
#define %NAME%_H

#include <stdint.h>

#define %NAME%_CHANNELS (%channels%U)
#define %NAME%_TERMS    (%terms%U)
#define %NAME%_SQUARED  (%squared%U)

/* Squared length of signals that are answered. */
#define %NAME%_WEAKEST2   (%weakest2%)
#define %NAME%_STRONGEST2 (%strongest2%)
/* The same in fixed point. */
#define %NAME%_WEAKEST_Q  (%weakest_q%)
#define %NAME%_STRONGEST_Q (%strongest_q%)

typedef enum
{
    %NAME%_OK = 0,          /* a direction was found */
    %NAME%_OUTSIDE = 1      /* the reading lies outside what was calibrated, or is no number */
} %name%_status_t;

/* Fixed point is given signals times this. */
extern const float %name%_per_unit;
extern const float %name%_first_f[3U * %NAME%_CHANNELS];
extern const float %name%_terms_f[8U * %NAME%_TERMS * 3U];
extern const float %name%_signals_f[8U * %NAME%_CHANNELS * 4U];
extern const float %name%_away2_f[8];
extern const int32_t %name%_first_q20[3U * %NAME%_CHANNELS];
extern const int32_t %name%_terms_q24[8U * %NAME%_TERMS * 3U];
extern const int32_t %name%_signals_q24[8U * %NAME%_CHANNELS * 4U];
extern const int64_t %name%_away2_q30[8];

/* Direction cosines of signals; sun is zero unless OK. */
%name%_status_t %name%_sun(const float signals[%NAME%_CHANNELS], float sun[3]);

/* The same in fixed point: signals times per_unit; sun in Q30. */
%name%_status_t %name%_sun_q(const int32_t signals_q[%NAME%_CHANNELS], int32_t sun_q30[3]);

#endif /* %NAME%_H */
