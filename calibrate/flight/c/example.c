/*
 * Reads lines of %columns_said% and prints status, direction, angles and one sigma of each.
 * Calibration SHA-256, first 32 digits: %digest%
 */
#include "%name%.h"

#ifndef %NAME%_RUN_%run%
#error "%name%_example.c and %name%.h are of different calibrations: copy both from one run"
#endif

#include <stdio.h>

int main(void)
{
    double number;
    %name%_reading in = { { 0 }, 0 };
    int count = 0;

    while (scanf("%lf", &number) == 1)
    {
        if (count < %NAME%_READINGS)
        {
            in.value[count] = (%name%_real)number;
        }
        else
        {
            in.temperature = (%name%_real)number;
        }
        count++;
        if (count == %columns%)
        {
            %name%_answer out;
            const %name%_status status = %name%_solve(&in, &out);

            (void)printf("%d %.12f %.12f %.12f %.9f %.9f %.6g %.6g\n", (int)status,
                         (double)out.sun[0], (double)out.sun[1], (double)out.sun[2],
                         (double)out.angle_deg[0], (double)out.angle_deg[1],
                         (double)out.sigma_deg[0], (double)out.sigma_deg[1]);
            count = 0;
        }
    }
    return 0;
}
