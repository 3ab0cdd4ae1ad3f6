// PNG files.
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <filesystem>

#include "viewer/picture.h"

namespace limn::viewer {
namespace {

namespace fs = std::filesystem;

class Png : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "limn_png_XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_;
};

TEST_F(Png, KeepsEveryByte) {
    Picture picture = {37, 11, {}};
    for (uint32_t i = 0; i < 3 * 37 * 11; ++i) picture.rgb.push_back(static_cast<uint8_t>(i * 7));
    const std::string path = (folder_ / "picture.png").string();
    auto file = FileWriter::create(path);
    ASSERT_TRUE(file) << file.error().message;
    const auto written = write_png(std::move(*file), picture);
    ASSERT_TRUE(written) << written.error().message;
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_file(&image, path.c_str())) << image.message;
    image.format = PNG_FORMAT_RGB;
    EXPECT_EQ(image.width, 37u);
    EXPECT_EQ(image.height, 11u);
    std::vector<uint8_t> read(PNG_IMAGE_SIZE(image));
    ASSERT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr)) << image.message;
    EXPECT_EQ(read, picture.rgb);
}

TEST_F(Png, LeavesNothingWhereItCannotWrite) {
    auto file = FileWriter::create((folder_ / "empty.png").string());
    ASSERT_TRUE(file) << file.error().message;
    ASSERT_FALSE(write_png(std::move(*file), {}));  // libpng refuses it
    EXPECT_TRUE(fs::is_empty(folder_));
}

}  // namespace
}  // namespace limn::viewer
