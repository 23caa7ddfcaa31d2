#ifdef ONE_TERM
#define VALUES 3
#else
#define VALUES (3 * TERMS)
#endif
