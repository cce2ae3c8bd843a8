/* helper: bend */
/* A response at a cosine, bent softly to nothing in the dark, and its slope. */
static real bend(real cosine, const real b[4], real width, real *slope)
{
    const real front = larger(cosine, R(0.0));
    /* a line that rises towards the front, whatever the fit says of grazing light */
    const real rise = larger(b[1], R(0.1) * (b[0] + b[1] + b[2] + b[3]));
    real value = (((((b[3] * front) + b[2]) * front) + b[1]) * front) + b[0] +
                 (rise * (cosine - front));
    const real ratio = value / width;

    *slope = (cosine > R(0.0)) ? ((((R(3.0) * b[3] * front) + (R(2.0) * b[2])) * front) + b[1])
                               : rise;
    if (ratio < R(-40.0))
    {
        value = R(0.0);
        *slope = R(0.0);
    }
    else if (ratio <= R(40.0))
    {
        const real decay = EXP(-ABS(ratio));
        const real share = ((ratio > R(0.0)) ? R(1.0) : decay) / (R(1.0) + decay);

        value = width * (larger(ratio, R(0.0)) + LOG1P(decay));
        *slope *= share;
    }
    else
    {
        /* lit: the response itself */
    }
    return value;
}
/* step: assembled_faces */
    /* the vector that best explains all signals, by Levenberg and Marquardt's steps */
    real vector[3] = { R(0.0), R(0.0), R(0.0) };
    real m[6] = { R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0) };
    real right[3] = { R(0.0), R(0.0), R(0.0) };
    real inverse[6];
    real step[3] = { R(0.0), R(0.0), R(0.0) };
    real damping = R(1e-4);
    real cost = R(0.0);
    real here = R(0.0);
    bool lit = false;
    bool moving = true;
    int round;
    int i;

    for (i = 0; i < FACES; i++)
    {
        v[i] -= dark[i];
        if (v[i] > (R(3.0) * noise[i]))
        {
            lit = true;
            add_row(m, right, &normal[3 * i], inverted(v[i], &response[4 * i]));
        }
    }
    m[0] += R(1e-6);
    m[3] += R(1e-6);
    m[5] += R(1e-6);
    (void)solve_three(m, right, vector, inverse);
    here = SQRT((vector[0] * vector[0]) + (vector[1] * vector[1]) + (vector[2] * vector[2]));
    /* off the ridge between two dark faces, whose side rounding would choose */
    vector[0] += here * R(6e-4);
    vector[1] += here * R(5e-4);
    vector[2] += here * R(7e-4);
    lit = lit && (here > R(0.0));
    /* the first round is at the start itself */
    for (round = 0; lit && moving && (round <= STEPS); round++)
    {
        real on_trial[6] = { R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0) };
        real pull[3] = { R(0.0), R(0.0), R(0.0) };
        real tried[3];
        real row[3];
        real found = R(0.0);
        real level;
        real steady;

        if (round > 0)
        {
            real damped[6];
            const real more = damping * (m[0] + m[3] + m[5]);

            for (i = 0; i < 6; i++)
            {
                damped[i] = m[i];
            }
            damped[0] += more;
            damped[3] += more;
            damped[5] += more;
            if (!solve_three(damped, right, step, inverse))
            {
                lit = false;
            }
        }
        for (i = 0; i < 3; i++)
        {
            tried[i] = vector[i] + step[i];
        }
        here = (vector[0] * vector[0]) + (vector[1] * vector[1]) + (vector[2] * vector[2]);
        level = SQRT((tried[0] * tried[0]) + (tried[1] * tried[1]) + (tried[2] * tried[2]));
        sun[0] = tried[0] / level;
        sun[1] = tried[1] / level;
        sun[2] = tried[2] / level;
        for (i = 0; i < FACES; i++)
        {
            const real *n = &normal[3 * i];
            const real cosine = (sun[0] * n[0]) + (sun[1] * n[1]) + (sun[2] * n[2]);
            real slope;
            const real value = bend(cosine, &response[4 * i], width[i], &slope);
            const real residual = (v[i] - (level * value)) / noise[i];

            row[0] = ((value * sun[0]) + (slope * (n[0] - (cosine * sun[0])))) / noise[i];
            row[1] = ((value * sun[1]) + (slope * (n[1] - (cosine * sun[1])))) / noise[i];
            row[2] = ((value * sun[2]) + (slope * (n[2] - (cosine * sun[2])))) / noise[i];
            add_row(on_trial, pull, row, residual);
            found += residual * residual;
        }
        row[0] = sun[0] / level_spread;
        row[1] = sun[1] / level_spread;
        row[2] = sun[2] / level_spread;
        steady = (R(1.0) - level) / level_spread;
        add_row(on_trial, pull, row, steady);
        found += steady * steady;
        if ((round == 0) || (found <= (cost * (R(1.0) + RISE))))
        {
            for (i = 0; i < 3; i++)
            {
                vector[i] = tried[i];
                right[i] = pull[i];
            }
            for (i = 0; i < 6; i++)
            {
                m[i] = on_trial[i];
            }
            cost = found;
            damping = (round == 0) ? damping : larger(damping / R(10.0), R(1e-12));
        }
        else
        {
            damping = (damping < R(1e5)) ? (damping * R(10.0)) : R(1e6);
        }
        if (round > 0)
        {
            const real moved = (step[0] * step[0]) + (step[1] * step[1]) + (step[2] * step[2]);

            moving = !(moved <= (REST * here));
        }
    }
    if (lit && settled(vector, sun) && solve_three(m, right, step, inverse))
    {
        const real along = (inverse[0] * sun[0] * sun[0]) + (inverse[3] * sun[1] * sun[1]) +
                           (inverse[5] * sun[2] * sun[2]) +
                           (R(2.0) * ((inverse[1] * sun[0] * sun[1]) +
                                      (inverse[2] * sun[0] * sun[2]) +
                                      (inverse[4] * sun[1] * sun[2])));
        const real spread = ((inverse[0] + inverse[3] + inverse[5] - along) / R(2.0)) /
                            ((vector[0] * vector[0]) + (vector[1] * vector[1]) +
                             (vector[2] * vector[2]));

        if (!((spread >= R(0.0)) && (spread <= worst)))
        {
            status = %NAME%_NO_SOLUTION;
        }
    }
    else
    {
        status = %NAME%_NO_SOLUTION;
    }
