/* Numbers of %name%.h; load them as a table of the flight executive, or link them. */
#include "%name%.h"

@DATA@
