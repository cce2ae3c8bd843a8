/* Reads lines "x y" and prints the direction of each. */
#include "%name%.h"

#include <stdio.h>

int main(void)
{
    float x;
    float y;

    while (scanf("%f %f", &x, &y) == 2)
    {
        float sun[3];

        if (%name%_sun(x, y, sun) == %NAME%_OK)
        {
            (void)printf("%.7f %.7f %.7f\n", (double)sun[0], (double)sun[1], (double)sun[2]);
        }
        else
        {
            (void)printf("outside\n");
        }
    }
    return 0;
}
