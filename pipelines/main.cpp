// The program: everything happens in run_program.
#include "pipelines/run/run_context.h"

int main(int argc, char** argv) { return softgrain::run_program(argc, argv); }
