// SPDX-License-Identifier: Apache-2.0
#include "tools/version.h"

#include <fmt/format.h>
#include <oneapi/tbb/version.h>

#include "tools/build_versions.h"

namespace morsel::tools {
namespace {

std::string processor_features() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  std::string features = "SSE2";
  if (__builtin_cpu_supports("sse4.2")) features += " SSE4.2";
  if (__builtin_cpu_supports("avx")) features += " AVX";
  if (__builtin_cpu_supports("avx2")) features += " AVX2";
  if (__builtin_cpu_supports("fma")) features += " FMA";
  if (__builtin_cpu_supports("avx512f")) features += " AVX-512";
  return features;
#else
  return "not x86-64";
#endif
}

}  // namespace

std::string version_text() {
  return fmt::format(
      "morsel {}\n"
      "built with Embree {}, OpenImageIO {}, OpenEXR {}, Imath {}, oneTBB {} (running {}), "
      "assimp {}, TinyGLTF {}, nlohmann_json {}, CLI11 {}, spdlog {}\n"
      "compiler {}\n"
      "processor {}",
      kMorselVersion, kEmbreeVersion, kOpenImageIoVersion, kOpenExrVersion, kImathVersion,
      TBB_VERSION_STRING, TBB_runtime_version(), kAssimpVersion, kTinyGltfVersion, kJsonVersion,
      kCli11Version, kSpdlogVersion, kCompiler, processor_features());
}

}  // namespace morsel::tools
