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

@FIXED@
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
@ASKED@

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
