/*
 * From a raw reading of a Sun sensor to the direction of the Sun. Written by sunatlas calibrate.
 *
%said%
 */
#ifndef %NAME%_H
#define %NAME%_H

/* Names this run, so that files of two runs do not compile together. */
#define %NAME%_RUN_%run%

#ifdef __cplusplus
extern "C" {
#endif

#define %NAME%_READINGS %raw%

/* Define %NAME%_FLOAT to compute in single precision. */
#ifdef %NAME%_FLOAT
typedef float %name%_real;
#else
typedef double %name%_real;
#endif

typedef enum
{
    %NAME%_OK = 0,          /* a direction was found */
    %NAME%_NOT_FINITE = 1,  /* a reading is no number, or beyond 1e30 */
    %NAME%_DARK = 2,        /* less light than any that was calibrated, or zeros alone */
    %NAME%_SATURATED = 3,   /* a reading is at or beyond its lowest or highest */
    %NAME%_TOO_BRIGHT = 4,  /* more light than was calibrated */
    %NAME%_TEMPERATURE = 5, /* colder or warmer than any that was calibrated */
    %NAME%_OUTSIDE = 6,     /* outside the field that was calibrated */
    %NAME%_NO_SOLUTION = 7  /* no direction explains the readings */
} %name%_status;

/* Readings as the sensor gives them, in the order above. */
typedef struct
{
    %name%_real value[%NAME%_READINGS];
    %name%_real temperature; /* %temperature% */
} %name%_reading;

typedef struct
{
    %name%_real sun[3];       /* unit vector from the sensor to the Sun */
    %name%_real angle_deg[2]; /* the same as %angles% */
    %name%_real sigma_deg[2]; /* one sigma along two axes square to the direction s: the first along
                                 s cross x (s cross y where |s_x| >= 0.9), the second s cross it */
} %name%_answer;

/* SHA-256 of the calibration, the first 32 digits, as its JSON has it. */
extern const char %name%_digest[33];

/* Finds the direction of a reading; the answer is all zeros unless the status is OK. */
%name%_status %name%_solve(const %name%_reading *in, %name%_answer *out);

#ifdef %NAME%_SELFTEST
/* Compares %vectors% readings with what the calibrated model says of them; returns how many differ,
 * and the largest difference of those that were answered. */
int %name%_selftest(%name%_real *largest_deg);
#endif

#ifdef __cplusplus
}
#endif

#endif /* %NAME%_H */
