static int32_t cells(float reading, float low, float per)
{
    const double place = ((double)reading - (double)low) * (double)per * 65536.0;
    double bounded = place;

    if (bounded > 2147483000.0)
    {
        bounded = 2147483000.0;
    }
    if (bounded < -2147483000.0)
    {
        bounded = -2147483000.0;
    }
    return (int32_t)bounded;
}
@@
        const %name%_status_t one = %name%_sun(v->x, v->y, sun);
        const %name%_status_t two = %name%_sun_q(
            cells(v->x, %NAME%_LOW_X, %NAME%_PER_X), cells(v->y, %NAME%_LOW_Y, %NAME%_PER_Y),
            sun_q30);
