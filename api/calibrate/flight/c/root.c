/* Largest whole number whose square is no more. */
static uint32_t root(uint64_t square)
{
    uint64_t rest = square;
    uint64_t found = 0U;
    uint64_t bit = (uint64_t)1U << 62U;

    while (bit > rest)
    {
        bit >>= 2U;
    }
    while (bit != 0U)
    {
        if (rest >= (found + bit))
        {
            rest -= found + bit;
            found = (found >> 1U) + bit;
        }
        else
        {
            found >>= 1U;
        }
        bit >>= 2U;
    }
    return (uint32_t)found;
}
