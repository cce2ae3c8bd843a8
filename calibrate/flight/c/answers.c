/* part: across */
/* Two unit vectors square to a direction: s cross x (s cross y close to x), and s cross it. */
static void across(const real sun[3], real axis[2][3])
{
    const bool by_x = (ABS(sun[0]) < R(0.9));
    real length;
    int i;

    axis[0][0] = by_x ? R(0.0) : (-sun[2]);
    axis[0][1] = by_x ? sun[2] : R(0.0);
    axis[0][2] = by_x ? (-sun[1]) : sun[0];
    length = SQRT((axis[0][0] * axis[0][0]) + (axis[0][1] * axis[0][1]) +
                  (axis[0][2] * axis[0][2]));
    for (i = 0; i < 3; i++)
    {
        axis[0][i] /= length;
    }
    axis[1][0] = (sun[1] * axis[0][2]) - (sun[2] * axis[0][1]);
    axis[1][1] = (sun[2] * axis[0][0]) - (sun[0] * axis[0][2]);
    axis[1][2] = (sun[0] * axis[0][1]) - (sun[1] * axis[0][0]);
}

/* part: grazing */
/* Widens one sigma along the normal of a face that light grazes. */
static void grazing(const real sun[3], real sigma[2])
{
%constants%    real axis[2][3];
    real added[2] = { R(0.0), R(0.0) };
    int face;
    int i;

    across(sun, axis);
    for (face = 0; face < FACES; face++)
    {
        const real *n = &normals[3 * face];
        const real near = ((n[0] * sun[0]) + (n[1] * sun[1]) + (n[2] * sun[2])) / sine;

        if ((near * near) < R(1.0))
        {
            for (i = 0; i < 2; i++)
            {
                const real along =
                    (n[0] * axis[i][0]) + (n[1] * axis[i][1]) + (n[2] * axis[i][2]);

                added[i] += (R(1.0) - (near * near)) * along * along;
            }
        }
    }
    for (i = 0; i < 2; i++)
    {
        sigma[i] *= SQRT(R(1.0) + (grown * added[i]));
    }
}

/* part: turned */
/* Turns a direction, and one sigma to the two axes across the new one. */
static void turned(real sun[3], real sigma[2])
{
%constants%    real before[2][3];
    real after[2][3];
    real found[3];
    real variance[2] = { R(0.0), R(0.0) };
    int i;
    int j;
    int k;

    for (i = 0; i < 3; i++)
    {
        found[i] = (rotation[3 * i] * sun[0]) + (rotation[(3 * i) + 1] * sun[1]) +
                   (rotation[(3 * i) + 2] * sun[2]);
    }
    across(sun, before);
    across(found, after);
    for (k = 0; k < 2; k++)
    {
        for (j = 0; j < 2; j++)
        {
            real along = R(0.0);

            for (i = 0; i < 3; i++)
            {
                along += after[k][i] * ((rotation[3 * i] * before[j][0]) +
                                        (rotation[(3 * i) + 1] * before[j][1]) +
                                        (rotation[(3 * i) + 2] * before[j][2]));
            }
            variance[k] += (sigma[j] * along) * (sigma[j] * along);
        }
    }
    for (i = 0; i < 2; i++)
    {
        sigma[i] = SQRT(variance[i]);
    }
    for (i = 0; i < 3; i++)
    {
        sun[i] = found[i];
    }
}

