// Text in pictures on the host, in Dear ImGui's own font.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "viewer/picture.h"

namespace limn::viewer {

class Captions {
  public:
    /// `size`: pixels from line to line, a multiple of 13 for crisp letters.
    explicit Captions(float size);
    Captions(Captions&&) noexcept;
    ~Captions();

    /// Draws one line of ASCII text whose upper left corner is pixel (x, y); what lies outside is left out.
    void draw(Picture& picture, int x, int y, const std::string& text, std::array<uint8_t, 3> color) const;
    /// Pixels.
    int width(const std::string& text) const;
    int height() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace limn::viewer
