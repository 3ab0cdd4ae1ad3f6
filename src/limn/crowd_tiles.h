// Tiles of surfaces that make local points (limn/shared/grid_eval_params.h), for surfaces that come and go.
// Not part of the public interface.
//
// Tiles of one pass and size, a pool, lie together: one dispatch, which takes the first tile_count of them.
// Surfaces of a class and pass, a group, fill their tiles but for the last: whenever one goes, the group's
// last takes its place, and whenever a tile goes, the pool's last one does. So there are as many tiles as if
// all surfaces had been sorted anew.
#pragma once

#include <unordered_map>

#include "limn/patch_tree.h"
#include "limn/word_changes.h"

namespace limn {

/// Tiles [first_tile, first_tile + tile_count) of kCrowdTileWords each, from CrowdTiles::tile_base() on.
struct TilePool {
    uint32_t pass, group_count, sample_count;
    uint32_t first_tile, tile_capacity;
    uint32_t tile_count = 0;
};
inline constexpr uint32_t kCrowdTileWords =
    shared::kGridTileHeader + shared::kGridTileSurfaceWords * shared::kGridMaxTileSurfaces;

class CrowdTiles {
  public:
    /// A class by the number that it gets, and how many of its samples are local points: the others are
    /// padding.
    uint32_t add_class(const GridClass& grid_class, uint32_t local_count);
    /// Before lay_out: so many surfaces will be added.
    void expect(uint32_t grid_class, uint32_t pass, uint32_t surface_count) {
        groups_[group_of(grid_class, pass)].count += surface_count;
    }
    /// Makes room for what is expected, and a `reserve` of it, for surfaces below surface_capacity. False:
    /// 2^32 words.
    bool lay_out(float reserve, uint32_t surface_capacity);

    /// The surface's ring, and its first local point counted from the first of the pass. False: there is no
    /// room.
    bool add(uint32_t surface, uint32_t grid_class, uint32_t pass, uint32_t first_ring, uint32_t first_local);
    void remove(uint32_t surface);

    const Array<uint32_t>& words() const { return words_; }
    uint32_t tile_base() const { return tile_base_; }
    const std::vector<TilePool>& pools() const { return pools_; }
    WordChanges changes;

  private:
    struct Class {
        GridClass grid;
        uint32_t placement;
    };
    struct Group {
        uint32_t grid_class, pass;
        uint32_t count = 0;
        std::vector<uint32_t> tiles = {};
    };
    struct Place {
        uint32_t group, entry;
    };
    uint32_t group_of(uint32_t grid_class, uint32_t pass);
    bool write_placement(Class& c);
    void add_pool(const Group& group, uint32_t tile_capacity);
    uint32_t take_tile(const Group& group);
    void free_tile(uint32_t tile);
    uint32_t* tile_words(uint32_t tile) {
        return words_.data() + tile_base_ + size_t{tile} * kCrowdTileWords;
    }
    void mark_tile(uint32_t tile) {
        changes.mark(tile_base_ + uint64_t{tile} * kCrowdTileWords, kCrowdTileWords);
    }

    Array<uint32_t> words_;
    uint32_t tile_base_ = 0, placement_end_ = 0;
    uint32_t tile_capacity_ = 0, pooled_tiles_ = 0;
    std::vector<Class> classes_;
    std::vector<uint32_t> local_counts_;  ///< of classes
    std::vector<Group> groups_;
    std::unordered_map<uint64_t, uint32_t> group_numbers_;
    std::vector<TilePool> pools_;
    std::vector<uint32_t> tile_surfaces_;  ///< the surface of each entry of each tile
    std::vector<Place> tile_places_;       ///< of each tile: the group, and which of its tiles
    std::vector<Place> places_;            ///< of each surface
};

}  // namespace limn
