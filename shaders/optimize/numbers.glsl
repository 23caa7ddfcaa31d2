// The numbers of problems, four to a layer (optim/verbs.h), and their dot products, one to a layer.
uniform sampler2DArray state;
uniform sampler2DArray products;

float number_at(int number, ivec2 problem) { return texelFetch(state, ivec3(problem, number / 4), 0)[number % 4]; }
