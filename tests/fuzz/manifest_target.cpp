// SPDX-License-Identifier: GPL-3.0-or-later
//
// Bytes -> the manifest reader of `spheretree batch`. The first byte is the format: j for JSON, else CSV.

#include "fuzz_target.hpp"
#include "io/manifest.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace spheretree;
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::string path = fuzz::asFile(bytes.substr(1), bytes[0] == 'j' ? ".json" : ".csv");
  const auto entries = io::readManifest(path);
  const bool named = entries.ok() || entries.error().message.find("input") != std::string::npos;
  fuzz::failOn(named ? "" : "the error does not name the file: " + entries.error().message);
  return 0;
}
