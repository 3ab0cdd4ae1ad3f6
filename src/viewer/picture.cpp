#include "viewer/picture.h"

#include <png.h>

#include <algorithm>

namespace limn::viewer {
namespace {

void append_bytes(png_structp png, png_bytep bytes, size_t count) {
    FileWriter& writer = *static_cast<FileWriter*>(png_get_io_ptr(png));
    for (size_t at = 0; at < count; at += FileWriter::kBufferBytes)
        writer.append(
            {reinterpret_cast<const char*>(bytes) + at, std::min(count - at, FileWriter::kBufferBytes)});
}

void ignore_flush(png_structp) {}

/// libpng leaves by longjmp where it fails: nothing here may need a destructor. False then.
bool encode(png_structp png, png_infop info, const Picture& picture) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_IHDR(png, info, picture.width, picture.height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (uint32_t y = 0; y < picture.height; ++y) png_write_row(png, picture.at(0, y));
    png_write_end(png, info);
    return true;
}

}  // namespace

Result<void> write_png(FileWriter file, const Picture& picture) {
    const auto silent = [](png_structp png, png_const_charp) { png_longjmp(png, 1); };
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, silent, [](auto, auto) {});
    png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
    bool done = false;
    if (info != nullptr) {
        png_set_write_fn(png, &file, append_bytes, ignore_flush);
        done = encode(png, info, picture);
    }
    png_destroy_write_struct(&png, &info);
    if (!done) return Error{ErrorCode::invalid_argument, "libpng cannot write this picture"};
    return file.commit();
}

}  // namespace limn::viewer
