/* helper: chebyshev */
/* Chebyshev's polynomials 0 to degree at u. */
static void chebyshev(real terms[], int degree, real u)
{
    int i;

    terms[0] = R(1.0);
    if (degree > 0)
    {
        terms[1] = u;
    }
    for (i = 2; i <= degree; i++)
    {
        terms[i] = (R(2.0) * u * terms[i - 1]) - terms[i - 2];
    }
}
/* helper: weigh */
/* Weights of a cubic spline's four nodes at a fraction of a cell. */
static void weigh(real t, real w[4])
{
    const real rest = R(1.0) - t;

    w[0] = (rest * rest * rest) / R(6.0);
    w[1] = (t * t * ((R(0.5) * t) - R(1.0))) + R(2.0 / 3.0);
    w[2] = (((((R(0.5) - (R(0.5) * t)) * t) + R(0.5)) * t)) + R(1.0 / 6.0);
    w[3] = (t * t * t) / R(6.0);
}
/* helper: cell_of */
/* The cell of a place, the first or the last but one where it lies beyond. */
static int cell_of(real place, int nodes)
{
    const int last = nodes - 3;
    int cell = 1;

    if (place >= (real)last)
    {
        cell = last;
    }
    else if (place > R(1.0))
    {
        cell = (int)place;
    }
    else
    {
        /* the first */
    }
    return cell;
}
/* step: polynomial */
    real tx[DEGREE + 1];
    real ty[DEGREE + 1];
    real tt[WARM + 1];
    real found[OUTPUTS];
    int at = 0;
    int output;
    int warm;
    int i;
    int j;

    chebyshev(tx, DEGREE, (v[0] - middle[0]) / half[0]);
    chebyshev(ty, DEGREE, (v[1] - middle[1]) / half[1]);
    chebyshev(tt, WARM, (kelvin - middle[2]) / half[2]);
    for (output = 0; output < OUTPUTS; output++)
    {
        found[output] = R(0.0);
        for (warm = 0; warm <= WARM; warm++)
        {
            for (j = 0; j <= DEGREE; j++)
            {
                real row = R(0.0);

                for (i = 0; i <= (DEGREE - j); i++)
                {
                    row += coefficients[at] * tx[i];
                    at++;
                }
                found[output] += tt[warm] * ty[j] * row;
            }
        }
    }
    for (output = 0; output < OUTPUTS; output++)
    {
        v[output] = found[output];
    }
/* step: axis_polynomials */
    int axis;
    int i;

    for (axis = 0; axis < 2; axis++)
    {
        real terms[DEGREE + 1];
        real found = R(0.0);

        chebyshev(terms, DEGREE, (v[axis] - middle[axis]) / half[axis]);
        for (i = 0; i <= DEGREE; i++)
        {
            found += coefficients[(axis * (DEGREE + 1)) + i] * terms[i];
        }
        v[axis] = found;
    }
/* step: spline */
    const real x = (v[0] - first[0]) * per_step[0];
    const real y = (v[1] - first[1]) * per_step[1];
    const int column = cell_of(x, COLUMNS);
    const int line = cell_of(y, LINES);
    real wx[4];
    real wy[4];
    int i;
    int j;

    weigh(x - (real)column, wx);
    weigh(y - (real)line, wy);
    v[0] = R(0.0);
    v[1] = R(0.0);
    for (j = 0; j < 4; j++)
    {
        for (i = 0; i < 4; i++)
        {
            const int at = 2 * ((((line + j) - 1) * COLUMNS) + ((column + i) - 1));
            const real weight = wy[j] * wx[i];

            v[0] += weight * nodes[at];
            v[1] += weight * nodes[at + 1];
        }
    }
/* helper: to_sun */
/* The unit vector of two tangents. */
static void to_sun(real x, real y, real sun[3])
{
    const real length = SQRT((x * x) + (y * y) + R(1.0));

    sun[0] = x / length;
    sun[1] = y / length;
    sun[2] = R(1.0) / length;
}
/* step: tangents */
    if ((ABS(v[0]) <= R(1e15)) && (ABS(v[1]) <= R(1e15)))
    {
        to_sun(v[0], v[1], sun);
    }
    else
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: angles */
    const real right = R(1.5707963267948966);

    if ((ABS(v[0]) < right) && (ABS(v[1]) < right))
    {
        to_sun(TAN(v[0]), TAN(v[1]), sun);
    }
    else
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: ratio */
    const real length = SQRT((v[0] * v[0]) + (v[1] * v[1]) + (v[2] * v[2]));

    if (v[2] > R(0.0))
    {
        sun[0] = v[0] / length;
        sun[1] = v[1] / length;
        sun[2] = v[2] / length;
    }
    else
    {
        status = %NAME%_NO_SOLUTION;
    }
