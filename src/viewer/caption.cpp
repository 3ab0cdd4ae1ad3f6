#include "viewer/caption.h"

#include <cmath>

#include "imgui.h"

namespace limn::viewer {

struct Captions::State {
    ImFontAtlas atlas;
    ImFont* font = nullptr;
    const uint8_t* coverage = nullptr;
    int width = 0, height = 0;

    void draw_glyph(Picture& picture, const ImFontGlyph& glyph, int x, int y, std::array<uint8_t, 3> color) const;
};

/// Bitmap glyphs: texels are pixels.
void Captions::State::draw_glyph(Picture& picture, const ImFontGlyph& glyph, int x, int y,
                                 std::array<uint8_t, 3> color) const {
    const int u = static_cast<int>(std::lround(glyph.U0 * static_cast<float>(width)));
    const int v = static_cast<int>(std::lround(glyph.V0 * static_cast<float>(height)));
    const int w = static_cast<int>(std::lround(glyph.X1 - glyph.X0)), h = static_cast<int>(std::lround(glyph.Y1 - glyph.Y0));
    for (int j = 0; j < h; ++j)
        for (int i = 0; i < w; ++i) {
            const int px = x + i, py = y + j;
            if (px < 0 || py < 0 || px >= static_cast<int>(picture.width) || py >= static_cast<int>(picture.height)) continue;
            const int alpha = coverage[(v + j) * width + u + i];
            uint8_t* pixel = picture.rgb.data() + 3 * (static_cast<size_t>(py) * picture.width + static_cast<size_t>(px));
            for (size_t k = 0; k < 3; ++k)
                pixel[k] = static_cast<uint8_t>((pixel[k] * (255 - alpha) + color[k] * alpha + 127) / 255);
        }
}

Captions::Captions(float size) : state_(std::make_unique<State>()) {
    ImFontConfig config;
    config.SizePixels = size;
    config.OversampleH = config.OversampleV = 1;
    config.PixelSnapH = true;
    state_->font = state_->atlas.AddFontDefault(&config);
    unsigned char* pixels = nullptr;
    state_->atlas.GetTexDataAsAlpha8(&pixels, &state_->width, &state_->height);
    state_->coverage = pixels;
}
Captions::Captions(Captions&&) noexcept = default;
Captions::~Captions() = default;

void Captions::draw(Picture& picture, int x, int y, const std::string& text, std::array<uint8_t, 3> color) const {
    auto pen = static_cast<float>(x);
    for (const char letter : text) {
        const ImFontGlyph* glyph = state_->font->FindGlyph(static_cast<ImWchar>(letter));
        if (glyph == nullptr) continue;
        if (glyph->Visible != 0)
            state_->draw_glyph(picture, *glyph, static_cast<int>(std::lround(pen + glyph->X0)),
                               y + static_cast<int>(std::lround(glyph->Y0)), color);
        pen += glyph->AdvanceX;
    }
}

int Captions::width(const std::string& text) const {
    float sum = 0;
    for (const char letter : text) sum += state_->font->GetCharAdvance(static_cast<ImWchar>(letter));
    return static_cast<int>(std::ceil(sum));
}

int Captions::height() const {
    return static_cast<int>(std::ceil(state_->font->FontSize));
}

}  // namespace limn::viewer
