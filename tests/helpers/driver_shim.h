// The part of the CUDA driver's interface that cuda_driver.py uses, for kernels that are functions for the CPU.
#include <malloc.h>

#include <cstdlib>
#include <cstring>

struct Kernel {
  const char* name;
  void (*run)(const void* words, int blocks, int rows);
  int threads;  // of a real block that a block here stands for; 0: all
};
static Kernel* find_kernel(const char* name);

using Address = unsigned long long;
static void *const CONTEXT = (void*)16, *const MODULE = (void*)32, *const STREAM = (void*)48;

extern "C" {
int cuCtxSetCurrent(void* context) { return context == CONTEXT ? 0 : 201; }
int cuStreamCreate(void** stream, unsigned flags) { return *stream = STREAM, flags == 1 ? 0 : 1; }
int cuStreamDestroy_v2(void* stream) { return stream == STREAM ? 0 : 400; }
int cuStreamSynchronize(void* stream) { return stream == STREAM ? 0 : 400; }
int cuMemAllocAsync(Address* at, size_t bytes, void* stream) {
  *at = (Address)malloc(bytes);
  memset((void*)*at, 0xa5, bytes);
  return stream == STREAM ? 0 : 400;
}
int cuMemFreeAsync(Address at, void* stream) {
  memset((void*)at, 0xa5, malloc_usable_size((void*)at));
  free((void*)at);
  return stream == STREAM ? 0 : 400;
}
int cuMemsetD8Async(Address at, unsigned char value, size_t bytes, void* stream) {
  memset((void*)at, value, bytes);
  return stream == STREAM ? 0 : 400;
}
int cuMemcpyHtoDAsync_v2(Address at, const void* from, size_t bytes, void* stream) {
  memcpy((void*)at, from, bytes);
  return stream == STREAM ? 0 : 400;
}
int cuMemcpyDtoHAsync_v2(void* to, Address at, size_t bytes, void* stream) {
  memcpy(to, (const void*)at, bytes);
  return stream == STREAM ? 0 : 400;
}
int cuModuleGetFunction(void** function, void* module, const char* name) {
  return *function = find_kernel(name), module == MODULE && *function ? 0 : 500;
}
int cuLaunchKernel(void* function, unsigned x, unsigned y, unsigned z, unsigned threads, unsigned, unsigned, unsigned,
                   void* stream, void** given, void** extra) {
  auto* kernel = (Kernel*)function;
  if (z != 1 || extra || stream != STREAM) return 1;
  kernel->run(given[0], kernel->threads ? x * threads / kernel->threads : x, y);
  return 0;
}
int cuGetErrorString(int, const char** text) { return *text = "refused by the shim", 0; }
}
