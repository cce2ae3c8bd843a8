/* See %name%.h. */
#include "%name%.h"

#include <math.h>

static uint32_t corner_of(int32_t whole, uint32_t count)
{
    uint32_t corner;

    if (whole < 1)
    {
        corner = 1U;
    }
    else if ((uint32_t)whole > (count - 3U))
    {
        corner = count - 3U;
    }
    else
    {
        corner = (uint32_t)whole;
    }
    return corner;
}

static void weights_f(float t, float w[4])
{
    w[0] = ((((-0.5F * t) + 1.0F) * t) - 0.5F) * t;
    w[1] = (((1.5F * t) - 2.5F) * t * t) + 1.0F;
    w[2] = ((((-1.5F * t) + 2.0F) * t) + 0.5F) * t;
    w[3] = ((0.5F * t) - 0.5F) * t * t;
}

%name%_status_t %name%_sun(float x, float y, float sun[3])
{
    %name%_status_t status = %NAME%_OK;
    const float px = (x - %NAME%_LOW_X) * %NAME%_PER_X;
    const float py = (y - %NAME%_LOW_Y) * %NAME%_PER_Y;
    uint32_t side;

    sun[0] = 0.0F;
    sun[1] = 0.0F;
    sun[2] = 0.0F;
    /* no number fails both comparisons, and readings far outside are no array index */
    if (!((px >= 0.0F) && (px <= %NAME%_LAST_X) &&
          (py >= 0.0F) && (py <= %NAME%_LAST_Y)))
    {
        status = %NAME%_OUTSIDE;
    }
    for (side = 0U; (status == %NAME%_OK) && (side < %NAME%_SIDES); side++)
    {
        const float over = (%name%_sides_f[3U * side] * px) +
                           (%name%_sides_f[(3U * side) + 1U] * py) +
                           %name%_sides_f[(3U * side) + 2U];
        if (over > 0.0F)
        {
            status = %NAME%_OUTSIDE;
        }
    }
    if (status == %NAME%_OK)
    {
        const uint32_t column = corner_of((int32_t)px, %NAME%_COLUMNS);
        const uint32_t row = corner_of((int32_t)py, %NAME%_ROWS);
        float wx[4];
        float wy[4];
        float sx = 0.0F;
        float sy = 0.0F;
        float square;
        uint32_t i;
        uint32_t j;

        weights_f(px - (float)column, wx);
        weights_f(py - (float)row, wy);
        for (j = 0U; j < 4U; j++)
        {
            float row_x = 0.0F;
            float row_y = 0.0F;
            for (i = 0U; i < 4U; i++)
            {
                const uint32_t at =
                    ((((row + j) - 1U) * %NAME%_COLUMNS) + ((column + i) - 1U)) * 2U;
                row_x += wx[i] * %name%_nodes_f[at];
                row_y += wx[i] * %name%_nodes_f[at + 1U];
            }
            sx += wy[j] * row_x;
            sy += wy[j] * row_y;
        }
        square = (sx * sx) + (sy * sy);
        if (square >= 1.0F)
        {
            status = %NAME%_OUTSIDE;
        }
        else
        {
            sun[0] = sx;
            sun[1] = sy;
            sun[2] = sqrtf(1.0F - square);
        }
    }
    return status;
}

/* A number divided by 65536, rounded to the nearest. */
static int64_t scaled(int64_t number)
{
    const int64_t half = 32768;
    const int64_t one = 65536;

    return (number >= 0) ? ((number + half) / one) : ((number - half) / one);
}

static void weights_q(int64_t t_q16, int64_t w_q16[4])
{
    const int64_t one = 65536;
    const int64_t t2 = scaled(t_q16 * t_q16);
    const int64_t t3 = scaled(t2 * t_q16);

    w_q16[0] = ((-t3 + (2 * t2)) - t_q16) / 2;
    w_q16[1] = (((3 * t3) - (5 * t2)) / 2) + one;
    w_q16[2] = (((-3 * t3) + (4 * t2)) + t_q16) / 2;
    /* so that they add up to one */
    w_q16[3] = one - (w_q16[0] + w_q16[1] + w_q16[2]);
}

@ROOT@
%name%_status_t %name%_sun_q(int32_t x_q16, int32_t y_q16, int32_t sun_q30[3])
{
    %name%_status_t status = %NAME%_OK;
    const int64_t one = 65536;
    const int64_t x = (int64_t)x_q16;
    const int64_t y = (int64_t)y_q16;
    uint32_t side;

    sun_q30[0] = 0;
    sun_q30[1] = 0;
    sun_q30[2] = 0;
    if ((x < 0) || (x > (((int64_t)%NAME%_COLUMNS - 1) * one)) ||
        (y < 0) || (y > (((int64_t)%NAME%_ROWS - 1) * one)))
    {
        status = %NAME%_OUTSIDE;
    }
    for (side = 0U; (status == %NAME%_OK) && (side < %NAME%_SIDES); side++)
    {
        const int64_t over = scaled((int64_t)%name%_sides_q16[3U * side] * x) +
                             scaled((int64_t)%name%_sides_q16[(3U * side) + 1U] * y) +
                             (int64_t)%name%_sides_q16[(3U * side) + 2U];
        if (over > 0)
        {
            status = %NAME%_OUTSIDE;
        }
    }
    if (status == %NAME%_OK)
    {
        const uint32_t column = corner_of((int32_t)(x / one), %NAME%_COLUMNS);
        const uint32_t row = corner_of((int32_t)(y / one), %NAME%_ROWS);
        const int64_t unit = INT64_C(1152921504606846976); /* one in Q60 */
        int64_t wx[4];
        int64_t wy[4];
        int64_t sx = 0;
        int64_t sy = 0;
        int64_t left;
        uint32_t i;
        uint32_t j;

        weights_q(x - ((int64_t)column * one), wx);
        weights_q(y - ((int64_t)row * one), wy);
        for (j = 0U; j < 4U; j++)
        {
            int64_t row_x = 0;
            int64_t row_y = 0;
            for (i = 0U; i < 4U; i++)
            {
                const uint32_t at =
                    ((((row + j) - 1U) * %NAME%_COLUMNS) + ((column + i) - 1U)) * 2U;
                row_x += wx[i] * (int64_t)%name%_nodes_q30[at];
                row_y += wx[i] * (int64_t)%name%_nodes_q30[at + 1U];
            }
            sx += scaled(wy[j] * scaled(row_x));
            sy += scaled(wy[j] * scaled(row_y));
        }
        left = unit - ((sx * sx) + (sy * sy));
        if (left <= 0)
        {
            status = %NAME%_OUTSIDE;
        }
        else
        {
            sun_q30[0] = (int32_t)sx;
            sun_q30[1] = (int32_t)sy;
            sun_q30[2] = (int32_t)root((uint64_t)left);
        }
    }
    return status;
}
