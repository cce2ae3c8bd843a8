static void fixed(const float signals[%NAME%_CHANNELS], int32_t signals_q[%NAME%_CHANNELS])
{
    uint32_t i;

    for (i = 0U; i < %NAME%_CHANNELS; i++)
    {
        double part = (double)signals[i] * (double)%name%_per_unit;

        part = (part > 2147483000.0) ? 2147483000.0 : part;
        part = (part < -2147483000.0) ? -2147483000.0 : part;
        signals_q[i] = (int32_t)part;
    }
}
@@
        int32_t signals_q[%NAME%_CHANNELS];

        fixed(v->signals, signals_q);
        const %name%_status_t one = %name%_sun(v->signals, sun);
        const %name%_status_t two = %name%_sun_q(signals_q, sun_q30);
