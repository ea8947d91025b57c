// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include <spheretree/result.hpp>

#include "image.hpp"

namespace crowded_room {

/// Writes a PNG file, whole or not at all; one that exists is replaced. Fails with UnwritableOutput.
spheretree::Result<spheretree::Done> writePng(const std::filesystem::path& path, const Image& image);

/// Reads any PNG file as red, green, blue. Fails with UnreadableInput.
spheretree::Result<Image> readPng(const std::filesystem::path& path);

}  // namespace crowded_room
