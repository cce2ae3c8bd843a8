/* helper: unit */
/* A vector of length one; false where it has no length. */
static bool unit(real vector[3])
{
    const real length =
        SQRT((vector[0] * vector[0]) + (vector[1] * vector[1]) + (vector[2] * vector[2]));
    const bool good = (length > R(0.0)) && (length <= R(1e18));

    if (good)
    {
        vector[0] /= length;
        vector[1] /= length;
        vector[2] /= length;
    }
    return good;
}
/* helper: settled */
/* Writes a vector of length one as the direction; false where it has no length. */
static bool settled(const real vector[3], real sun[3])
{
    sun[0] = vector[0];
    sun[1] = vector[1];
    sun[2] = vector[2];
    return unit(sun);
}
/* helper: larger */
static real larger(real one, real other)
{
    return (one > other) ? one : other;
}
/* helper: inverted */
/* The cosine in [0, 1.2] at which a cubic response gives a signal, by six of Newton's steps. */
static real inverted(real signal, const real b[4])
{
    real cosine = signal / (b[0] + b[1] + b[2] + b[3]);
    int i;

    for (i = 0; i <= 6; i++)
    {
        if (i > 0)
        {
            const real value = (((((b[3] * cosine) + b[2]) * cosine) + b[1]) * cosine) + b[0];
            const real slope =
                larger((((R(3.0) * b[3] * cosine) + (R(2.0) * b[2])) * cosine) + b[1],
                       R(0.1) * b[1]);

            cosine -= (value - signal) / slope;
        }
        cosine = larger(cosine, R(0.0));
        cosine = (cosine > R(1.2)) ? R(1.2) : cosine;
    }
    return cosine;
}
/* helper: solve_three */
/* Symmetric equations xx, xy, xz, yy, yz, zz, and the inverse's elements in that order; false
 * where there is no solution. */
static bool solve_three(const real m[6], const real right[3], real found[3], real inverse[6])
{
    const real first = (m[3] * m[5]) - (m[4] * m[4]);
    const real second = (m[2] * m[4]) - (m[1] * m[5]);
    const real third = (m[1] * m[4]) - (m[2] * m[3]);
    const real determinant = (m[0] * first) + (m[1] * second) + (m[2] * third);
    const bool good = (determinant > R(0.0)) || (determinant < R(0.0));

    if (good)
    {
        inverse[0] = first / determinant;
        inverse[1] = second / determinant;
        inverse[2] = third / determinant;
        inverse[3] = ((m[0] * m[5]) - (m[2] * m[2])) / determinant;
        inverse[4] = ((m[1] * m[2]) - (m[0] * m[4])) / determinant;
        inverse[5] = ((m[0] * m[3]) - (m[1] * m[1])) / determinant;
        found[0] = (inverse[0] * right[0]) + (inverse[1] * right[1]) + (inverse[2] * right[2]);
        found[1] = (inverse[1] * right[0]) + (inverse[3] * right[1]) + (inverse[4] * right[2]);
        found[2] = (inverse[2] * right[0]) + (inverse[4] * right[1]) + (inverse[5] * right[2]);
    }
    return good;
}
/* helper: add_row */
/* Adds one equation to normal equations. */
static void add_row(real m[6], real right[3], const real row[3], real residual)
{
    m[0] += row[0] * row[0];
    m[1] += row[0] * row[1];
    m[2] += row[0] * row[2];
    m[3] += row[1] * row[1];
    m[4] += row[1] * row[2];
    m[5] += row[2] * row[2];
    right[0] += row[0] * residual;
    right[1] += row[1] * residual;
    right[2] += row[2] * residual;
}
/* step: warmth */
    /* signals at the reference temperature */
    int i;

    for (i = 0; i < FACES; i++)
    {
        const real change = R(1.0) + (coefficient[i] * (kelvin - reference));

        if (change > R(0.0))
        {
            v[i] /= change;
        }
        else
        {
            status = %NAME%_TEMPERATURE;
        }
    }
/* step: drift */
    /* signals times a polynomial of the temperature each, plus another */
    real terms[DEGREE + 1];
    int i;
    int j;

    chebyshev(terms, DEGREE, (kelvin - middle) / half);
    for (i = 0; i < FACES; i++)
    {
        real factor = R(0.0);
        real more = R(0.0);

        for (j = 0; j <= DEGREE; j++)
        {
            factor += gain[(j * FACES) + i] * terms[j];
            more += level[(j * FACES) + i] * terms[j];
        }
        v[i] = (v[i] * factor) + more;
    }
/* step: angular_loss */
    /* cosines of incidence by the inverse of the response */
    int i;

    for (i = 0; i < FACES; i++)
    {
        v[i] = inverted(v[i] / gain[i], response);
    }
/* step: maximum_currents */
    /* the brighter of each pair of opposite faces */
    int i;

    for (i = 0; i < 3; i++)
    {
        const real one = larger(v[plus[i]] / full[plus[i]], R(0.0));
        const real other = larger(v[minus[i]] / full[minus[i]], R(0.0));
        const bool front = (one >= other);

        v[plus[i]] = front ? (one * full[plus[i]]) : R(0.0);
        v[minus[i]] = front ? R(0.0) : (other * full[minus[i]]);
    }
/* step: brighter_faces */
    /* the brighter face of each pair is a component */
    real vector[3];
    int i;

    for (i = 0; i < 3; i++)
    {
        const real one = v[plus[i]];
        const real other = v[minus[i]];
        const real brighter = larger(larger(one, other), R(0.0));

        vector[i] = (one >= other) ? brighter : -brighter;
    }
    if (!settled(vector, sun))
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: weighted_normals */
    /* the lit faces' normals, weighted by their signals */
    real vector[3] = { R(0.0), R(0.0), R(0.0) };
    int i;
    int k;

    for (i = 0; i < FACES; i++)
    {
        for (k = 0; k < 3; k++)
        {
            vector[k] += normal[(3 * i) + k] * larger(v[i], R(0.0));
        }
    }
    if (!settled(vector, sun))
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: pyramidal */
    /* three sums over faces that are all lit */
    real vector[3] = { R(0.0), R(0.0), R(0.0) };
    real most = v[0];
    bool lit = true;
    int i;
    int k;

    for (i = 0; i < FACES; i++)
    {
        most = larger(most, v[i]);
        for (k = 0; k < 3; k++)
        {
            vector[k] += weight[(3 * i) + k] * v[i];
        }
    }
    for (i = 0; i < FACES; i++)
    {
        if (!(v[i] > larger(dark_share * most, R(0.0))))
        {
            lit = false;
        }
    }
    if (!settled(vector, sun) || !lit)
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: pyramidal_constant */
    /* two sums in which constant light cancels; the third component from the length */
    real x = R(0.0);
    real y = R(0.0);
    real mean = R(0.0);
    real square;
    int i;

    for (i = 0; i < FACES; i++)
    {
        x += weight[2 * i] * v[i];
        y += weight[(2 * i) + 1] * v[i];
        mean += v[i];
    }
    mean /= R(FACES);
    square = R(1.0) - (x * x) - (y * y);
    if (square > R(0.0))
    {
        const real z = SQRT(square);

        if (!(((mean * coefficient) - (up * z)) >= -misfit))
        {
            status = %NAME%_NO_SOLUTION;
        }
        for (i = 0; i < FACES; i++)
        {
            const real off = ((v[i] - mean) * coefficient) - (normal[2 * i] * x) -
                             (normal[(2 * i) + 1] * y);

            if (!(ABS(off) <= misfit))
            {
                status = %NAME%_NO_SOLUTION;
            }
        }
        sun[0] = x;
        sun[1] = y;
        sun[2] = z;
    }
    else
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: panoramic */
    /* weighted least squares over the cosines of the lit cells */
    const bool by_signal = (BY_SIGNAL == 1);
    real m[6] = { R(0.0), R(0.0), R(0.0), R(0.0), R(0.0), R(0.0) };
    real inverse[6];
    real right[3] = { R(0.0), R(0.0), R(0.0) };
    real vector[3] = { R(0.0), R(0.0), R(0.0) };
    real trace;
    real determinant;
    int i;

    for (i = 0; i < FACES; i++)
    {
        const real relative = v[i] / reference[i];

        if (relative >= least_cosine)
        {
            const real root = by_signal ? SQRT(relative) : R(1.0);
            const real row[3] = { normal[3 * i] * root, normal[(3 * i) + 1] * root,
                                  normal[(3 * i) + 2] * root };

            add_row(m, right, row, relative * root);
        }
    }
    trace = m[0] + m[3] + m[5];
    determinant = (m[0] * ((m[3] * m[5]) - (m[4] * m[4]))) +
                  (m[1] * ((m[2] * m[4]) - (m[1] * m[5]))) +
                  (m[2] * ((m[1] * m[4]) - (m[2] * m[3])));
    /* fewer than three lit, or three in a plane: rounding is all there is of a determinant */
    if (!(determinant > (flattest * trace * trace * trace)) ||
        !solve_three(m, right, vector, inverse) || !settled(vector, sun))
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: trig */
    /* the brighter face of each pair, three equations of its fitted cosine */
    real seen[3];
    real vector[3] = { R(0.0), R(0.0), R(0.0) };
    bool lit = false;
    int octant = 0;
    int i;
    int k;

    for (i = 0; i < 3; i++)
    {
        const real one = v[first[i]] - level[first[i]];
        const real other = v[second[i]] - level[second[i]];
        const bool later = (other / amplitude[second[i]]) > (one / amplitude[first[i]]);

        seen[i] = later ? other : one;
        octant += later ? bits[i] : 0;
        lit = lit || (seen[i] > R(0.0));
    }
    for (k = 0; k < 3; k++)
    {
        for (i = 0; i < 3; i++)
        {
            vector[k] += inverse[(9 * octant) + (3 * k) + i] * seen[i];
        }
    }
    if (!settled(vector, sun) || !lit)
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: trig_averaged */
    /* the brighter face of each pair, its cosine by the pair's curve */
    real vector[3] = { R(0.0), R(0.0), R(0.0) };
    bool lit = false;
    int i;
    int k;

    for (i = 0; i < 3; i++)
    {
        const real single = curve[(3 * i) + 1];
        const real twice = curve[(3 * i) + 2];
        const bool later = v[second[i]] > v[first[i]];
        const real above = larger(v[first[i]], v[second[i]]) - (curve[3 * i] - twice);
        const real square = (single * single) + (R(8.0) * twice * above);

        lit = lit || (above > R(0.0));
        if (square >= R(0.0))
        {
            const real root = SQRT(square);
            const real cosine = (single > R(0.0)) ? ((R(2.0) * above) / (single + root))
                                                  : ((root - single) / (R(4.0) * twice));

            for (k = 0; k < 3; k++)
            {
                vector[k] += normal[(3 * i) + k] * (later ? -cosine : cosine);
            }
        }
        else
        {
            status = %NAME%_NO_SOLUTION;
        }
    }
    if (!settled(vector, sun) || !lit)
    {
        status = %NAME%_NO_SOLUTION;
    }
/* step: signal_polynomial */
    /* each component as a polynomial of all signals */
    real terms[FACES][DEGREE + 1];
    real vector[3] = { R(0.0), R(0.0), R(0.0) };
    int i;
    int k;

    for (i = 0; i < FACES; i++)
    {
        const real scaled = (v[i] - middle[i]) / half[i];

        if (!(ABS(scaled) <= reach))
        {
            status = %NAME%_OUTSIDE;
        }
        chebyshev(terms[i], DEGREE, scaled);
    }
    for (k = 0; k < TERMS; k++)
    {
        real term = R(1.0);

        for (i = 0; i < FACES; i++)
        {
            term *= terms[i][power[(k * FACES) + i]];
        }
        vector[0] += coefficients[3 * k] * term;
        vector[1] += coefficients[(3 * k) + 1] * term;
        vector[2] += coefficients[(3 * k) + 2] * term;
    }
    if ((status == %NAME%_OK) && !settled(vector, sun))
    {
        status = %NAME%_NO_SOLUTION;
    }
