/*
 * See %name%.h.
 * Calibration SHA-256, first 32 digits: %digest%
 */
#include "%name%.h"

#ifndef %NAME%_RUN_%run%
#error "%name%.c and %name%.h are of different calibrations: copy both from one run"
#endif

#include <math.h>
#include <stdbool.h>

typedef %name%_real real;

#define R(x) ((real)(x))
#define WIDTH %width%
#ifdef %NAME%_FLOAT
#define ABS(x) fabsf(x)
#define SQRT(x) sqrtf(x)
#define TAN(x) tanf(x)
#define EXP(x) expf(x)
#define LOG1P(x) log1pf(x)
#define ATAN2(y, x) atan2f((y), (x))
#define RISE R(1e-6)
#define REST R(1e-12)
#else
#define ABS(x) fabs(x)
#define SQRT(x) sqrt(x)
#define TAN(x) tan(x)
#define EXP(x) exp(x)
#define LOG1P(x) log1p(x)
#define ATAN2(y, x) atan2((y), (x))
#define RISE R(1e-12)
#define REST R(1e-26)
#endif
#define DEGREES R(57.29577951308232)

const char %name%_digest[33] = "%digest%";

%functions%
%answers%/* One sigma of the direction, bilinear between rings off an axis and sectors of azimuth. */
static void sigma_at(const real sun[3], real sigma[2])
{
%sigma%
    const int sectors = SECTORS;
    real along[3];
    real off;
    real place;
    real share = R(0.0);
    int ring = 0;
    int sector;
    int i;
    int k;

    for (i = 0; i < 3; i++)
    {
        along[i] = (basis[3 * i] * sun[0]) + (basis[(3 * i) + 1] * sun[1]) +
                   (basis[(3 * i) + 2] * sun[2]);
    }
    off = ATAN2(SQRT((along[0] * along[0]) + (along[1] * along[1])), along[2]) * DEGREES;
    place = ATAN2(along[1], along[0]) * DEGREES * ((real)sectors / R(360.0));
    place = (place < R(0.0)) ? (place + (real)sectors) : place;
    sector = (int)place;
    place -= (real)sector;
    sector %= sectors;
    while ((ring < (RINGS - 2)) && (off > rings[ring + 1]))
    {
        ring++;
    }
    share = (off - rings[ring]) / (rings[ring + 1] - rings[ring]);
    share = (share < R(0.0)) ? R(0.0) : share;
    share = (share > R(1.0)) ? R(1.0) : share;
    for (k = 0; k < 2; k++)
    {
        const int next = (sector + 1) % sectors;
        const int here = ring * sectors;
        const int there = here + sectors;
        const real inner = ((R(1.0) - place) * table[(2 * (here + sector)) + k]) +
                           (place * table[(2 * (here + next)) + k]);
        const real outer = ((R(1.0) - place) * table[(2 * (there + sector)) + k]) +
                           (place * table[(2 * (there + next)) + k]);

        sigma[k] = ((R(1.0) - share) * inner) + (share * outer);
    }
%grown%}

%name%_status %name%_solve(const %name%_reading *in, %name%_answer *out)
{
    real v[WIDTH];
    real sun[3] = { R(0.0), R(0.0), R(1.0) };
    %name%_status status = %NAME%_OK;
    const real kelvin = %kelvin%;
    int i;

    for (i = 0; i < WIDTH; i++)
    {
        v[i] = R(0.0);
    }
    for (i = 0; i < %NAME%_READINGS; i++)
    {
        v[i] = in->value[i];
    }
    for (i = 0; i < 2; i++)
    {
        out->angle_deg[i] = R(0.0);
        out->sigma_deg[i] = R(0.0);
    }
%calls%
    if (status == %NAME%_OK)
    {
        sigma_at(sun, out->sigma_deg);
%turned%    }
    for (i = 0; i < 3; i++)
    {
        out->sun[i] = (status == %NAME%_OK) ? sun[i] : R(0.0);
    }
    if (status == %NAME%_OK)
    {
        const real x = sun[0];
        const real y = sun[1];
        const real z = sun[2];

        out->angle_deg[0] = %first_angle% * DEGREES;
        out->angle_deg[1] = %second_angle% * DEGREES;
    }
    return status;
}

#ifdef %NAME%_SELFTEST
typedef struct
{
    %name%_reading reading;
    real sun[3];
    %name%_status status;
} vector_type;

int %name%_selftest(%name%_real *largest_deg)
{
    /* readings of the calibration, and what the model answers; the last ones are to be refused */
    static const vector_type vectors[%vectors%] =
    {
%vector_data%
    };
#ifdef %NAME%_FLOAT
    const real most = R(%most_float%);
#else
    const real most = R(%most%);
#endif
    int wrong = 0;
    int at;

    *largest_deg = R(0.0);
    for (at = 0; at < %vectors%; at++)
    {
        const vector_type *v = &vectors[at];
        %name%_answer a;
        const %name%_status status = %name%_solve(&v->reading, &a);

        if (status != v->status)
        {
            wrong++;
        }
        else if (status == %NAME%_OK)
        {
            const real x = (a.sun[1] * v->sun[2]) - (a.sun[2] * v->sun[1]);
            const real y = (a.sun[2] * v->sun[0]) - (a.sun[0] * v->sun[2]);
            const real z = (a.sun[0] * v->sun[1]) - (a.sun[1] * v->sun[0]);
            const real off = SQRT((x * x) + (y * y) + (z * z)) * DEGREES;

            *largest_deg = (off > *largest_deg) ? off : *largest_deg;
            wrong += (off <= most) ? 0 : 1;
        }
        else
        {
            /* refused, as it has to be */
        }
    }
    return wrong;
}
#endif
