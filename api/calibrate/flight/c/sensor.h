/*
 * Sun direction of a calibrated Sun sensor. Written by sunatlas calibrate.
%said%
 *
 * Frame: +z is the boresight; the result is the unit vector from the sensor to the Sun.
 * Flash: about %flash% bytes of constants and code. Stack: below 160 bytes. No memory is
 * allocated and nothing is kept between calls. Operations: 42 multiplications, %sides% hull sides
 * of two each, and one square root, whatever the reading.
 */
#ifndef %NAME%_H
#define %NAME%_H

#include <stdint.h>

#define %NAME%_ROWS         (%rows%U)
#define %NAME%_COLUMNS      (%columns%U)
#define %NAME%_SIDES        (%sides%U)
#define %NAME%_NODES        (%NAME%_ROWS * %NAME%_COLUMNS * 2U)
#define %NAME%_SIDE_NUMBERS (%NAME%_SIDES * 3U)

/* First node, and nodes per unit of each feature. */
#define %NAME%_LOW_X (%low_x%)
#define %NAME%_LOW_Y (%low_y%)
#define %NAME%_PER_X (%per_x%)
#define %NAME%_PER_Y (%per_y%)
/* The last node. */
#define %NAME%_LAST_X (%last_x%)
#define %NAME%_LAST_Y (%last_y%)

typedef enum
{
    %NAME%_OK = 0,          /* a direction was found */
    %NAME%_OUTSIDE = 1      /* the reading lies outside what was calibrated, or is no number */
} %name%_status_t;

extern const float %name%_nodes_f[%NAME%_NODES];
extern const int32_t %name%_nodes_q30[%NAME%_NODES];
extern const float %name%_sides_f[%NAME%_SIDE_NUMBERS];
extern const int32_t %name%_sides_q16[%NAME%_SIDE_NUMBERS];

/* Direction cosines of a reading (x, y) in the calibration's units; sun is zero unless OK. */
%name%_status_t %name%_sun(float x, float y, float sun[3]);

/* The same in fixed point: x and y in nodes from the first one, Q16; sun in Q30.
 * cells = (reading - LOW) * PER; range -32768 to 32767 nodes. */
%name%_status_t %name%_sun_q(int32_t x_q16, int32_t y_q16, int32_t sun_q30[3]);

#endif /* %NAME%_H */
