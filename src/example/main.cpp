// example [--frames N] [--size WxH] [-o OUT.png] [--validation]: draws frames, writes the last one.
#include <png.h>

#include <string>

#include "renderer.h"

namespace {

struct Options {
    uint32_t frames = 48;
    VkExtent2D size = {720, 960};
    std::string output = "example.png";
    bool validation = false;
};

Options parse(int count, char** arguments) {
    Options options;
    for (int i = 1; i < count; ++i) {
        const std::string name = arguments[i];
        const char* value = i + 1 < count ? arguments[i + 1] : "";
        unsigned frames = 0, width = 0, height = 0;
        char rest = 0;
        if (name == "--validation") {
            options.validation = true;
            continue;
        }
        if (name == "--frames" && std::sscanf(value, "%u%c", &frames, &rest) == 1 && frames - 1 < 100'000)
            options.frames = frames;
        else if (name == "--size" && std::sscanf(value, "%ux%u%c", &width, &height, &rest) == 2 &&
                 width - 1 < 4096 && height - 1 < 4096)
            options.size = {width, height};
        else if (name == "-o" && *value != 0)
            options.output = value;
        else
            fail("usage: example [--frames N] [--size WxH] [-o OUT.png] [--validation]");
        ++i;
    }
    return options;
}

void write_png(const std::string& path, VkExtent2D size, const std::vector<uint8_t>& pixels) {
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    image.width = size.width;
    image.height = size.height;
    image.format = PNG_FORMAT_RGBA;
    if (png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, nullptr) == 0) fail(image.message);
}

}  // namespace

int main(int count, char** arguments) {
    const Options options = parse(count, arguments);
    ValidationLog log;
    Gpu gpu = create_gpu(options.validation ? &log : nullptr);
    std::vector<uint8_t> pixels;
    limn::vk::TessellationResult result;
    {
        const Mesh mesh = make_vase();
        Renderer renderer(gpu, options.size);
        for (uint32_t frame = 0; frame < options.frames; ++frame)
            renderer.draw(mesh, static_cast<float>(frame) / 60);
        result = renderer.read(pixels);
    }
    destroy_gpu(gpu);
    write_png(options.output, options.size, pixels);
    std::printf(
        "%u frames of %ux%u: %u vertices, %u triangles in the last, rates scaled by %g; %u validation "
        "messages\n",
        options.frames, options.size.width, options.size.height, result.vertex_count, result.triangle_count,
        static_cast<double>(result.rate_scale), log.count);
    return result.status == limn::vk::TessellationStatus::complete && log.count == 0 ? 0 : 1;
}
