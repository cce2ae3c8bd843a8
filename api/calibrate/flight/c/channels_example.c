/* Reads lines of %channels% signals and prints the direction of each. */
#include "%name%.h"

#include <stdio.h>

int main(void)
{
    float signals[%NAME%_CHANNELS];
    uint32_t count = 0U;

    while (scanf("%f", &signals[count]) == 1)
    {
        count++;
        if (count == %NAME%_CHANNELS)
        {
            float sun[3];

            if (%name%_sun(signals, sun) == %NAME%_OK)
            {
                (void)printf("%.7f %.7f %.7f\n", (double)sun[0], (double)sun[1], (double)sun[2]);
            }
            else
            {
                (void)printf("outside\n");
            }
            count = 0U;
        }
    }
    return 0;
}
