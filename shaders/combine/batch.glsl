// Passes over BATCH images at once. Calls for each image are written out, so that cameras and layers have constant
// indices: a variable one costs ten times as much on a software rasterizer.
#ifndef BATCH
#define BATCH 2
#endif
#if BATCH == 1
#define FOR_EACH_IMAGE(CALL) CALL(0);
#elif BATCH == 2
#define FOR_EACH_IMAGE(CALL) CALL(0); CALL(1);
#elif BATCH == 3
#define FOR_EACH_IMAGE(CALL) CALL(0); CALL(1); CALL(2);
#else
#define FOR_EACH_IMAGE(CALL) CALL(0); CALL(1); CALL(2); CALL(3);
#endif
