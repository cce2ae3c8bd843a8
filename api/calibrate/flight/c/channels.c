/* See %name%.h. */
#include "%name%.h"

#include <math.h>

static void terms_f(const float unit[%NAME%_CHANNELS], uint32_t octant, float found[3])
{
    const float *c = &%name%_terms_f[octant * %NAME%_TERMS * 3U];
    uint32_t at = 1U;
    uint32_t i;
    uint32_t j;
    uint32_t k;

    for (k = 0U; k < 3U; k++)
    {
        found[k] = c[k];
    }
    for (i = 0U; i < %NAME%_CHANNELS; i++)
    {
        for (k = 0U; k < 3U; k++)
        {
            found[k] += c[(3U * at) + k] * unit[i];
        }
        at++;
    }
    for (i = 0U; i < (%NAME%_CHANNELS * %NAME%_SQUARED); i++)
    {
        for (j = i; j < %NAME%_CHANNELS; j++)
        {
            const float both = unit[i] * unit[j];
            for (k = 0U; k < 3U; k++)
            {
                found[k] += c[(3U * at) + k] * both;
            }
            at++;
        }
    }
}

static uint32_t octant_f(const float unit[%NAME%_CHANNELS])
{
    uint32_t octant = 0U;
    uint32_t i;
    uint32_t k;

    for (k = 0U; k < 3U; k++)
    {
        float along = 0.0F;
        for (i = 0U; i < %NAME%_CHANNELS; i++)
        {
            along += %name%_first_f[(k * %NAME%_CHANNELS) + i] * unit[i];
        }
        if (along >= 0.0F)
        {
            octant |= (uint32_t)1U << k;
        }
    }
    return octant;
}

/* How far signals are from what a direction explains, squared. */
static float away2_f(const float unit[%NAME%_CHANNELS], uint32_t octant, const float sun[3])
{
    float away2 = 0.0F;
    uint32_t i;

    for (i = 0U; i < %NAME%_CHANNELS; i++)
    {
        const float *e = &%name%_signals_f[((octant * %NAME%_CHANNELS) + i) * 4U];
        const float apart =
            unit[i] - (((e[0] + (e[1] * sun[0])) + (e[2] * sun[1])) + (e[3] * sun[2]));
        away2 += apart * apart;
    }
    return away2;
}

%name%_status_t %name%_sun(const float signals[%NAME%_CHANNELS], float sun[3])
{
    %name%_status_t status = %NAME%_OUTSIDE;
    float unit[%NAME%_CHANNELS];
    float square = 0.0F;
    uint32_t i;

    sun[0] = 0.0F;
    sun[1] = 0.0F;
    sun[2] = 0.0F;
    for (i = 0U; i < %NAME%_CHANNELS; i++)
    {
        square += signals[i] * signals[i];
    }
    /* no number fails both comparisons */
    if ((square >= %NAME%_WEAKEST2) && (square <= %NAME%_STRONGEST2))
    {
        const float length = sqrtf(square);
        float found[3];
        float norm;
        uint32_t octant;

        for (i = 0U; i < %NAME%_CHANNELS; i++)
        {
            unit[i] = signals[i] / length;
        }
        octant = octant_f(unit);
        terms_f(unit, octant, found);
        norm = sqrtf(((found[0] * found[0]) + (found[1] * found[1])) + (found[2] * found[2]));
        if (norm > 0.1F)
        {
            for (i = 0U; i < 3U; i++)
            {
                found[i] /= norm;
            }
            if (away2_f(unit, octant, found) <= %name%_away2_f[octant])
            {
                sun[0] = found[0];
                sun[1] = found[1];
                sun[2] = found[2];
                status = %NAME%_OK;
            }
        }
    }
    return status;
}

/* A number over another, rounded to the nearest; the other is positive. */
static int64_t over(int64_t number, int64_t other)
{
    const int64_t half = other / 2;

    return (number >= 0) ? ((number + half) / other) : ((number - half) / other);
}

@ROOT@
/* One in Q24 and Q30. */
static const int64_t one_q24 = INT64_C(16777216);
static const int64_t one_q30 = INT64_C(1073741824);

static void terms_q(const int64_t unit[%NAME%_CHANNELS], uint32_t octant, int64_t found[3])
{
    const int32_t *c = &%name%_terms_q24[octant * %NAME%_TERMS * 3U];
    uint32_t at = 1U;
    uint32_t i;
    uint32_t j;
    uint32_t k;

    for (k = 0U; k < 3U; k++)
    {
        found[k] = (int64_t)c[k] * (one_q30 / one_q24);
    }
    for (i = 0U; i < %NAME%_CHANNELS; i++)
    {
        for (k = 0U; k < 3U; k++)
        {
            found[k] += over((int64_t)c[(3U * at) + k] * unit[i], one_q24);
        }
        at++;
    }
    for (i = 0U; i < (%NAME%_CHANNELS * %NAME%_SQUARED); i++)
    {
        for (j = i; j < %NAME%_CHANNELS; j++)
        {
            const int64_t both = over(unit[i] * unit[j], one_q30);
            for (k = 0U; k < 3U; k++)
            {
                found[k] += over((int64_t)c[(3U * at) + k] * both, one_q24);
            }
            at++;
        }
    }
}

static uint32_t octant_q(const int64_t unit[%NAME%_CHANNELS])
{
    const int64_t one_q20 = INT64_C(1048576);
    uint32_t octant = 0U;
    uint32_t i;
    uint32_t k;

    for (k = 0U; k < 3U; k++)
    {
        int64_t along = 0;
        for (i = 0U; i < %NAME%_CHANNELS; i++)
        {
            along += over((int64_t)%name%_first_q20[(k * %NAME%_CHANNELS) + i] * unit[i], one_q20);
        }
        if (along >= 0)
        {
            octant |= (uint32_t)1U << k;
        }
    }
    return octant;
}

static int64_t away2_q(const int64_t unit[%NAME%_CHANNELS], uint32_t octant, const int64_t sun[3])
{
    int64_t away2 = 0;
    uint32_t i;

    for (i = 0U; i < %NAME%_CHANNELS; i++)
    {
        const int32_t *e = &%name%_signals_q24[((octant * %NAME%_CHANNELS) + i) * 4U];
        const int64_t explained = ((int64_t)e[0] * (one_q30 / one_q24)) +
                                  over((int64_t)e[1] * sun[0], one_q24) +
                                  over((int64_t)e[2] * sun[1], one_q24) +
                                  over((int64_t)e[3] * sun[2], one_q24);
        const int64_t apart = over(unit[i] - explained, 32768); /* Q15 */
        away2 += apart * apart;
    }
    return away2;
}

%name%_status_t %name%_sun_q(const int32_t signals_q[%NAME%_CHANNELS], int32_t sun_q30[3])
{
    %name%_status_t status = %NAME%_OUTSIDE;
    const int64_t most = INT64_C(536870912); /* so that squares do not overflow */
    int64_t unit[%NAME%_CHANNELS];
    uint64_t square = 0U;
    int64_t length = 0;
    uint32_t i;

    sun_q30[0] = 0;
    sun_q30[1] = 0;
    sun_q30[2] = 0;
    for (i = 0U; i < %NAME%_CHANNELS; i++)
    {
        int64_t signal = (int64_t)signals_q[i];

        signal = (signal > most) ? most : signal;
        signal = (signal < -most) ? -most : signal;
        unit[i] = signal;
        signal *= signal;
        square += (uint64_t)signal;
    }
    length = (int64_t)root(square);
    if ((length >= %NAME%_WEAKEST_Q) && (length <= %NAME%_STRONGEST_Q))
    {
        const int64_t longest = one_q30 + (one_q30 / 2);
        int64_t found[3];
        uint32_t octant;

        for (i = 0U; i < %NAME%_CHANNELS; i++)
        {
            unit[i] = over(unit[i] * one_q30, length);
        }
        octant = octant_q(unit);
        terms_q(unit, octant, found);
        square = 0U;
        for (i = 0U; i < 3U; i++)
        {
            int64_t part = found[i];

            part = (part > longest) ? longest : part;
            part = (part < -longest) ? -longest : part;
            found[i] = part;
            part *= part;
            square += (uint64_t)part;
        }
        length = (int64_t)root(square);
        if (length > (one_q30 / 10))
        {
            for (i = 0U; i < 3U; i++)
            {
                found[i] = over(found[i] * one_q30, length);
            }
            if (away2_q(unit, octant, found) <= %name%_away2_q30[octant])
            {
                sun_q30[0] = (int32_t)found[0];
                sun_q30[1] = (int32_t)found[1];
                sun_q30[2] = (int32_t)found[2];
                status = %NAME%_OK;
            }
        }
    }
    return status;
}
