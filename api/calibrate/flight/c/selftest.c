/* Compares float and fixed point with the test vectors; exit status 0: all agree. */
#include "%name%.h"
#include "%name%_vectors.h"

#include <math.h>
#include <stdio.h>

static double apart_deg(const double a[3], const %name%_vector_t *v)
{
    const double x = (a[1] * (double)v->sun_z) - (a[2] * (double)v->sun_y);
    const double y = (a[2] * (double)v->sun_x) - (a[0] * (double)v->sun_z);
    const double z = (a[0] * (double)v->sun_y) - (a[1] * (double)v->sun_x);

    return sqrt((x * x) + (y * y) + (z * z)) * 57.29577951308232;
}

static int32_t cells(float reading, float low, float per)
{
    const double place = ((double)reading - (double)low) * (double)per * 65536.0;
    double bounded = place;

    if (bounded > 2147483000.0)
    {
        bounded = 2147483000.0;
    }
    if (bounded < -2147483000.0)
    {
        bounded = -2147483000.0;
    }
    return (int32_t)bounded;
}

int main(void)
{
    double worst_f = 0.0;
    double worst_q = 0.0;
    int wrong = 0;
    uint32_t at;

    for (at = 0U; at < %NAME%_VECTORS; at++)
    {
        const %name%_vector_t *v = &%name%_vectors[at];
        float sun[3];
        int32_t sun_q30[3];
        const %name%_status_t one = %name%_sun(v->x, v->y, sun);
        const %name%_status_t two = %name%_sun_q(
            cells(v->x, %NAME%_LOW_X, %NAME%_PER_X), cells(v->y, %NAME%_LOW_Y, %NAME%_PER_Y),
            sun_q30);

        const %name%_status_t expected = (v->valid != 0) ? %NAME%_OK : %NAME%_OUTSIDE;

        if ((one != expected) || (two != expected))
        {
            wrong++;
        }
        else if (v->valid != 0)
        {
            const double a[3] = { (double)sun[0], (double)sun[1], (double)sun[2] };
            const double b[3] = { (double)sun_q30[0] / 1073741824.0,
                                  (double)sun_q30[1] / 1073741824.0,
                                  (double)sun_q30[2] / 1073741824.0 };
            const double off_f = apart_deg(a, v);
            const double off_q = apart_deg(b, v);

            worst_f = (off_f > worst_f) ? off_f : worst_f;
            worst_q = (off_q > worst_q) ? off_q : worst_q;
        }
        else
        {
            /* outside for both, as it has to be */
        }
    }
    (void)printf("%u vectors, %d flags wrong, float within %.2e deg, "
                 "fixed point within %.2e deg\n",
                 %NAME%_VECTORS, wrong, worst_f, worst_q);
    return ((wrong == 0) && (worst_f <= 1e-4) && (worst_q <= 0.01)) ? 0 : 1;
}
