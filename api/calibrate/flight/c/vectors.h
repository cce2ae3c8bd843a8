/* Readings with the directions that the calibration's software gives for them. */
#ifndef %NAME%_VECTORS_H
#define %NAME%_VECTORS_H

#define %NAME%_VECTORS (%vectors%U)

typedef struct
{
    float x;
    float y;
    float sun_x;
    float sun_y;
    float sun_z;
    int valid;
} %name%_vector_t;

static const %name%_vector_t %name%_vectors[%NAME%_VECTORS] =
{
@DATA@
};

#endif /* %NAME%_VECTORS_H */
