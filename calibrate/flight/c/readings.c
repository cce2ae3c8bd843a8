/* step: readings */
    /* dark is taken off and gain divided out; limits are those of the calibration's readings */
    real raw[READINGS];
    real light = R(0.0);
    bool zeros = true;
    bool clipped = false;
    int i;

    for (i = 0; i < READINGS; i++)
    {
        raw[i] = v[place[i]];
        /* no number fails the comparison */
        if (!((raw[i] >= -largest) && (raw[i] <= largest)))
        {
            status = %NAME%_NOT_FINITE;
        }
        if ((raw[i] > R(0.0)) || (raw[i] < R(0.0)))
        {
            zeros = false;
        }
        if ((raw[i] <= low[i]) || (raw[i] >= high[i]))
        {
            clipped = true;
        }
    }
    for (i = 0; i < READINGS; i++)
    {
        v[i] = (raw[i] - dark[i]) / gain[i];
        light += v[i];
    }
    if (status == %NAME%_OK)
    {
        if (zeros || !(light >= least))
        {
            status = %NAME%_DARK;
        }
        else if (clipped)
        {
            status = %NAME%_SATURATED;
        }
        else if (light > most)
        {
            status = %NAME%_TOO_BRIGHT;
        }
        else
        {
            /* light enough, and not too much */
        }
    }
/* step: quadrants */
    /* quadrants at (-x, +y), (+x, +y), (+x, -y), (-x, -y) to two balances */
    const real total = v[0] + v[1] + v[2] + v[3];

    if (total > R(0.0))
    {
        const real x = (v[1] + v[2] - v[0] - v[3]) / total;
        const real y = (v[0] + v[1] - v[2] - v[3]) / total;

        v[0] = x;
        v[1] = y;
    }
    else
    {
        status = %NAME%_DARK;
    }
/* step: electrodes */
    /* electrodes x+, x-, y+, y- to two balances */
    const real along = v[0] + v[1];
    const real up = v[2] + v[3];

    if ((along > R(0.0)) && (up > R(0.0)))
    {
        const real x = (v[0] - v[1]) / along;
        const real y = (v[2] - v[3]) / up;

        v[0] = x;
        v[1] = y;
    }
    else
    {
        status = %NAME%_DARK;
    }
/* step: axes */
    /* both features swapped, mirrored or rotated */
    const real x = (matrix[0] * v[0]) + (matrix[1] * v[1]);
    const real y = (matrix[2] * v[0]) + (matrix[3] * v[1]);

    v[0] = x;
    v[1] = y;
/* step: temperature_range */
    if (!((kelvin >= low) && (kelvin <= high)))
    {
        status = %NAME%_TEMPERATURE;
    }
/* step: cone */
    /* the direction inside those that were calibrated */
    int i;

    for (i = 0; i < SIDES; i++)
    {
        const real past = (normal[3 * i] * sun[0]) + (normal[(3 * i) + 1] * sun[1]) +
                          (normal[(3 * i) + 2] * sun[2]) + offset[i];

        if (!(past <= margin))
        {
            status = %NAME%_OUTSIDE;
        }
    }
/* step: hull */
    /* both features inside those that were calibrated */
    int i;

    for (i = 0; i < SIDES; i++)
    {
        const real past = (normal[2 * i] * v[0]) + (normal[(2 * i) + 1] * v[1]) + offset[i];

        if (!(past <= margin))
        {
            status = %NAME%_OUTSIDE;
        }
    }
