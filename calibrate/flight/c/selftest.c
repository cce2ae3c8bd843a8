/*
 * Runs the self-test of %name%.c, which %NAME%_SELFTEST has to be defined for; exit status 0: passed.
 * Calibration SHA-256, first 32 digits: %digest%
 */
#include "%name%.h"

#ifndef %NAME%_RUN_%run%
#error "%name%_selftest.c and %name%.h are of different calibrations: copy both from one run"
#endif

#include <stdio.h>

int main(void)
{
    %name%_real largest;
    const int wrong = %name%_selftest(&largest);

    (void)printf("%vectors% readings, %d differ from the model, largest difference %.2e deg\n",
                 wrong, (double)largest);
    return (wrong == 0) ? 0 : 1;
}
