#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "dataset/dataset.h"

/// What shows that a packed dataset's files are as they were written.
namespace radiafit {

/// Bytes of one image in images.bin: pixels, mask, and zeros up to the next image. From version 4 on they are in this
/// order without a gap, and View::checksum is of all of them.
uint64_t image_block_bytes(const View& view, Encoding encoding);

/// How many bytes from View::pixel_offset on check_image_bytes() looks at: the block, or without a checksum the pixels.
uint64_t checked_bytes(const View& view, Encoding encoding);

/// Throws UserError, naming `images_file` and the view, unless the image is what was written: by its checksum, or in an
/// older dataset, of floats, by their being finite and not above View::peak.
void check_image_bytes(const View& view, Encoding encoding, std::span<const uint8_t> bytes,
                       const std::filesystem::path& images_file);

/// hash_bytes() of a whole file. Throws SystemError where it cannot be read.
uint64_t file_checksum(const std::filesystem::path& file);

/// file_checksum() of dataset.json, as text: it holds the checksums of every image and every other file, so two
/// datasets with one checksum are the same to the byte. Empty before version 4, which has no others. Throws SystemError
/// where it cannot be read.
std::string dataset_checksum(const Dataset& dataset);

/// What a run's record says of a dataset that it read: a JSON object with name, source (of absolute paths the
/// last two names), checksum and the bytes of its files.
std::string dataset_note(const Dataset& dataset);

/// Throws UserError if the dataset has a checksum of its file `name` and the file has another one.
void check_file(const Dataset& dataset, const std::string& name);

/// Reads every pixel once, on all threads, and every other file that has a checksum. Throws UserError that names file
/// and view for the first that is not as it was written.
void check_pixels(const Dataset& dataset);

}  // namespace radiafit
