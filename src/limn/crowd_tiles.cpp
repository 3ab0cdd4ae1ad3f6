#include "limn/crowd_tiles.h"

#include <cassert>
#include <cstring>
#include <map>
#include <tuple>

#include "limn/topology.h"

namespace limn {
namespace {

constexpr uint32_t kTileSurfaces = shared::kGridMaxTileSurfaces;
constexpr uint32_t kLeastPool = 16;  ///< tiles: a dispatch has its price

uint32_t tiles_of(uint32_t surface_count) {
    return surface_count / kTileSurfaces + (surface_count % kTileSurfaces != 0);
}
uint32_t placement_words(const GridClass& c) {
    return shared::kGridPlacementHeader + c.sample_count;
}

}  // namespace

uint32_t CrowdTiles::add_class(const GridClass& grid_class, uint32_t local_count) {
    classes_.push_back({grid_class, 0});
    local_counts_.push_back(local_count);
    return static_cast<uint32_t>(classes_.size() - 1);
}

uint32_t CrowdTiles::group_of(uint32_t grid_class, uint32_t pass) {
    const auto [at, is_new] = group_numbers_.try_emplace(uint64_t{pass} << 32 | grid_class, groups_.size());
    if (is_new) groups_.push_back({grid_class, pass});
    return at->second;
}

bool CrowdTiles::lay_out(float reserve, uint32_t surface_capacity) {
    // Half of the reserve is in pools, half for pools to come.
    const auto with_reserve = [&](uint64_t count) {
        return count + static_cast<uint64_t>(static_cast<double>(reserve) / 2 * static_cast<double>(count)) +
               kLeastPool;
    };
    uint64_t placements = 1;
    for (const Class& c : classes_) placements += placement_words(c.grid);
    placements = with_reserve(placements) + 1024;
    std::map<std::tuple<uint32_t, uint32_t, uint32_t>, std::pair<const Group*, uint64_t>> wanted;
    for (const Group& group : groups_) {
        const GridClass& c = classes_[group.grid_class].grid;
        auto& [any, tiles] = wanted[{group.pass, c.group_count, c.sample_count}];
        any = &group;
        tiles += tiles_of(group.count);
    }
    uint64_t pooled = 0;
    for (const auto& [key, pool] : wanted) pooled += with_reserve(pool.second);
    const uint64_t tiles = with_reserve(pooled) + 4 * kLeastPool;
    if (placements + tiles * kCrowdTileWords > kInvalidIndex) return false;
    tile_capacity_ = static_cast<uint32_t>(tiles);
    tile_base_ = static_cast<uint32_t>(placements);
    words_.assign(placements + tiles * kCrowdTileWords, 0);
    placement_end_ = 1;
    tile_surfaces_.resize(tiles * kTileSurfaces);
    tile_places_.resize(tiles);
    places_.resize(surface_capacity);
    for (const auto& [key, pool] : wanted)
        add_pool(*pool.first, static_cast<uint32_t>(with_reserve(pool.second)));
    for (Group& group : groups_) group.count = 0;
    return true;
}

void CrowdTiles::add_pool(const Group& group, uint32_t tile_capacity) {
    const GridClass& c = classes_[group.grid_class].grid;
    pools_.push_back({group.pass, c.group_count, c.sample_count, pooled_tiles_, tile_capacity});
    pooled_tiles_ += tile_capacity;
}

/// Local point s of the surface is sample s.
bool CrowdTiles::write_placement(Class& c) {
    const uint32_t count = placement_words(c.grid),
                   locals = local_counts_[static_cast<size_t>(&c - classes_.data())];
    if (placement_end_ + count > tile_base_) return false;
    c.placement = placement_end_;
    uint32_t* word = words_.data() + c.placement;
    for (const uint32_t turn : {1u, 0u, 0u, 1u}) *word++ = turn;
    for (uint32_t s = 0; s < c.grid.sample_count; ++s) *word++ = s < locals ? s : shared::kGridNoSample;
    changes.mark(c.placement, count);
    placement_end_ += count;
    return true;
}

uint32_t CrowdTiles::take_tile(const Group& group) {
    const GridClass& c = classes_[group.grid_class].grid;
    uint32_t alike = 0;
    for (int attempt = 0; attempt < 2; ++attempt) {
        for (TilePool& pool : pools_) {
            if (pool.pass != group.pass || pool.group_count != c.group_count ||
                pool.sample_count != c.sample_count)
                continue;
            if (pool.tile_count < pool.tile_capacity) return pool.first_tile + pool.tile_count++;
            alike += pool.tile_capacity;
        }
        const uint32_t room = tile_capacity_ - pooled_tiles_;
        if (room == 0) break;
        add_pool(group, std::min(room, std::max(kLeastPool, alike / 2)));
    }
    return kInvalidIndex;
}

bool CrowdTiles::add(uint32_t surface, uint32_t grid_class, uint32_t pass, uint32_t first_ring,
                     uint32_t first_local) {
    Class& c = classes_[grid_class];
    if (c.placement == 0 && !write_placement(c)) return false;
    const uint32_t number = group_of(grid_class, pass);
    Group& group = groups_[number];
    const uint32_t entry = group.count % kTileSurfaces;
    if (entry == 0) {
        const uint32_t tile = take_tile(group);
        if (tile == kInvalidIndex) return false;
        tile_places_[tile] = {number, static_cast<uint32_t>(group.tiles.size())};
        group.tiles.push_back(tile);
        uint32_t* words = tile_words(tile);
        std::memset(words, 0, kCrowdTileWords * 4);
        words[0] = c.grid.first_weight;
        words[2] = c.grid.ring_size;
    }
    const uint32_t tile = group.tiles.back();
    uint32_t* words = tile_words(tile);
    words[1] = entry + 1;
    uint32_t* own = words + shared::kGridTileHeader + shared::kGridTileSurfaceWords * entry;
    own[0] = first_ring;
    own[1] = first_local;
    own[2] = c.placement;
    tile_surfaces_[size_t{tile} * kTileSurfaces + entry] = surface;
    places_[surface] = {number, group.count++};
    mark_tile(tile);
    return true;
}

void CrowdTiles::remove(uint32_t surface) {
    const Place place = places_[surface];
    Group& group = groups_[place.group];
    const uint32_t last = --group.count, last_tile = group.tiles.back(), last_entry = last % kTileSurfaces;
    assert(last / kTileSurfaces + 1 == group.tiles.size());
    if (place.entry != last) {
        const uint32_t tile = group.tiles[place.entry / kTileSurfaces], entry = place.entry % kTileSurfaces;
        const auto entry_words = [&](uint32_t t, uint32_t e) {
            return tile_words(t) + shared::kGridTileHeader + shared::kGridTileSurfaceWords * e;
        };
        std::memcpy(entry_words(tile, entry), entry_words(last_tile, last_entry),
                    shared::kGridTileSurfaceWords * 4);
        const uint32_t moved = tile_surfaces_[size_t{last_tile} * kTileSurfaces + last_entry];
        tile_surfaces_[size_t{tile} * kTileSurfaces + entry] = moved;
        places_[moved].entry = place.entry;
        mark_tile(tile);
    }
    tile_words(last_tile)[1] = last_entry;
    mark_tile(last_tile);
    if (last_entry != 0) return;
    group.tiles.pop_back();
    free_tile(last_tile);
}

void CrowdTiles::free_tile(uint32_t tile) {
    const auto pool = std::find_if(pools_.begin(), pools_.end(), [&](const TilePool& p) {
        return tile >= p.first_tile && tile - p.first_tile < p.tile_capacity;
    });
    const uint32_t last = pool->first_tile + --pool->tile_count;
    if (tile == last) return;
    std::memcpy(tile_words(tile), tile_words(last), kCrowdTileWords * 4);
    std::copy_n(tile_surfaces_.data() + size_t{last} * kTileSurfaces, kTileSurfaces,
                tile_surfaces_.data() + size_t{tile} * kTileSurfaces);
    const Place owner = tile_places_[tile] = tile_places_[last];
    groups_[owner.group].tiles[owner.entry] = tile;
    mark_tile(tile);
}

}  // namespace limn
