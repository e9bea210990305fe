// SPDX-License-Identifier: MIT
// The attributes of a page: normals, then palette indices, coded alike by encoder and decoder.
#pragma once

#include <algorithm>
#include <type_traits>
#include <utility>

#include "page_occupancy.h"
#include "page_state.h"

namespace kelp::coding {

inline constexpr std::uint32_t kNeighbors = 18, kMostVotes = 24;  // 6 sides and 12 edges

// Of the 27 voxels around: the corners do not vote.
inline constexpr std::array<std::uint8_t, 27> kVotes = {0, 1, 0, 1, 2, 1, 0, 1, 0, 1, 2, 1, 2, 0,
                                                        2, 1, 2, 1, 0, 1, 0, 1, 2, 1, 0, 1, 0};
inline constexpr std::uint32_t kVoters = [] {
  std::uint32_t voters = 0;
  for (std::uint32_t i = 0; i < 27; ++i) voters |= kVotes[i] > 0 ? 1u << i : 0u;
  return voters;
}();

// 2^20 / n, rounded up.
inline constexpr std::array<std::uint32_t, 8 * kMostVotes + 2> kInverse = [] {
  std::array<std::uint32_t, 8 * kMostVotes + 2> inverse{};
  for (std::uint32_t n = 1; n < inverse.size(); ++n) inverse[n] = ((1u << 20) + n - 1) / n;
  return inverse;
}();

// The different values of a list: the one with most votes first, the one with most of the others second, then
// the others.
struct Ballot {
  std::array<std::uint32_t, kNeighbors> value, votes;
  std::uint32_t count = 0, all;

  explicit Ballot(std::uint32_t votes_cast) : all(votes_cast) {}

  // Counts the votes for the first value: valueOf(i), with votesOf(i) votes, for i < voters; at least one.
  // True: it has more than half of them all, and so its place.
  template <class ValueOf, class VotesOf>
  bool begin(std::uint32_t voters, const ValueOf& valueOf, const VotesOf& votesOf) {
    sift(voters, valueOf(0), valueOf, votesOf);
    return 2 * votes[0] > all;
  }
  // Counts the others.
  void finish() {
    while (left_ > 0)
      sift(
          left_, left_value_[0], [&](std::uint32_t i) { return left_value_[i]; },
          [&](std::uint32_t i) { return left_votes_[i]; });
    for (std::uint32_t place = 0; place < 2 && place < count; ++place) {
      std::uint32_t best = place;
      for (std::uint32_t i = place + 1; i < count; ++i) best = votes[i] > votes[best] ? i : best;
      std::swap(votes[place], votes[best]);
      std::swap(value[place], value[best]);
    }
  }
  // How many eighths of all votes, less than 8.
  std::uint32_t share(std::uint32_t i) const { return (votes[i] * kInverse[all + 1]) >> 17; }

 private:
  // Adds a value with all its votes, and keeps the other voters.
  template <class ValueOf, class VotesOf>
  void sift(std::uint32_t voters, std::uint32_t candidate, const ValueOf& valueOf, const VotesOf& votesOf) {
    std::uint32_t sum = 0, left = 0;
    for (std::uint32_t i = 0; i < voters; ++i) {
      const std::uint32_t v = valueOf(i), w = votesOf(i);
      const bool other = v != candidate;
      sum += other ? 0 : w;
      left_value_[left] = v;
      left_votes_[left] = w;
      left += other;
    }
    value[count] = candidate;
    votes[count++] = sum;
    left_ = left;
  }

  std::array<std::uint32_t, kNeighbors> left_value_, left_votes_;
  std::uint32_t left_ = 0;
};

// The attributes of coded voxels around a voxel.
struct Neighbors {
  std::uint32_t count = 0, votes_cast = 0, fresh = 0;  // fresh: how many of their normals were new
  bool alike = true;                                   // whether they all have the same normal
  std::array<std::uint32_t, kNeighbors> attribute;
  std::array<std::uint32_t, kNeighbors> votes;
};

// The coded surface voxels of a brick and around it. Voxel (x, y, z) is at x + 1 of row (y + 1, z + 1).
class CodedWindow {
 public:
  void start(const PageState& state, std::size_t brick, std::span<const std::uint32_t> attributes) {
    rows_.fill(0);
    for (std::size_t i = 0; i < 27; ++i) {
      const int there = state.around[brick][i];
      if (there < 0 || there >= static_cast<int>(brick)) continue;
      copyFrom(state, static_cast<std::size_t>(there), static_cast<int>(i % 3) - 1,
               static_cast<int>(i / 3 % 3) - 1, static_cast<int>(i / 9) - 1, attributes);
    }
  }

  void find(std::size_t x, std::size_t y, std::size_t z, Neighbors& out) const {
    const std::size_t row = y + 10 * z;
    const auto three = [&](std::size_t r) {
      return (rows_[row + r % 3 + 10 * (r / 3)] >> x & 0x700000007u) << (3 * r);
    };
    const std::uint64_t both =
        three(0) | three(1) | three(2) | three(3) | three(4) | three(5) | three(6) | three(7) | three(8);
    std::uint32_t mask = static_cast<std::uint32_t>(both) & kVoters;
    const auto fresh = static_cast<std::uint32_t>(both >> 32);
    const std::uint32_t* const corner = &attribute_[x + 10 * row];
    std::uint32_t count = 0, cast = 0, new_ones = 0, differ = 0, first = 0;
    for (; mask != 0; ++count) {  // the last first: it is beside the voxel
      const auto i = static_cast<std::size_t>(std::bit_width(mask) - 1);
      mask ^= 1u << i;
      const std::uint32_t attribute = corner[kOffsets[i]];
      if (count == 0) first = attribute;
      differ |= attribute ^ first;
      new_ones += fresh >> i & 1;
      out.attribute[count] = attribute;
      out.votes[count] = std::uint32_t{kVotes[i]} << (fresh >> i & 1);
      cast += out.votes[count];
    }
    out.count = count;
    out.votes_cast = cast;
    out.fresh = new_ones;
    out.alike = differ >> 8 == 0;
  }

  void set(std::size_t x, std::size_t y, std::size_t z, std::uint32_t attribute, bool fresh) {
    const std::size_t row = y + 1 + 10 * (z + 1);
    rows_[row] |= (1 | std::uint64_t{fresh} << 32) << (x + 1);
    attribute_[x + 1 + 10 * row] = attribute;
  }

 private:
  static constexpr std::array<std::uint16_t, 27> kOffsets = [] {
    std::array<std::uint16_t, 27> offsets{};
    for (std::size_t i = 0; i < 27; ++i)
      offsets[i] = static_cast<std::uint16_t>(i % 3 + 10 * (i / 3 % 3) + 100 * (i / 9));
    return offsets;
  }();

  // Copies what lies beside this brick from the one at (dx, dy, dz) from it.
  void copyFrom(const PageState& state, std::size_t there, int dx, int dy, int dz,
                std::span<const std::uint32_t> attributes) {
    const auto first = [](int d) { return d < 0 ? 7 : 0; };
    const auto last = [](int d) { return d > 0 ? 0 : 7; };
    const std::uint32_t in_row = dx < 0 ? 0x80 : dx > 0 ? 1 : 0xff;
    for (int z = first(dz); z <= last(dz); ++z) {
      for (int y = first(dy); y <= last(dy); ++y) {
        std::uint32_t bits =
            static_cast<std::uint32_t>(state.surface[there][static_cast<std::size_t>(z)] >> (8 * y)) & in_row;
        for (; bits != 0; bits &= bits - 1) {
          const int x = std::countr_zero(bits);
          const std::uint16_t at = state.index[there][static_cast<std::size_t>(x + 8 * y + 64 * z)];
          const auto row = static_cast<std::size_t>(y + 8 * dy + 1 + 10 * (z + 8 * dz + 1));
          const auto column = static_cast<std::size_t>(x + 8 * dx + 1);
          rows_[row] |= (1 | std::uint64_t{state.fresh[at]} << 32) << column;
          attribute_[column + 10 * row] = attributes[at];
        }
      }
    }
  }

  std::array<std::uint64_t, 100> rows_;  // bit x + 1: known; bit x + 33: and its normal was new
  std::array<std::uint32_t, 1000> attribute_;
};

template <class Coder>
class AttributeCoder {
 public:
  AttributeCoder(const Coder& coder, const PageHeader& header, std::uint32_t palette, Models& models)
      : coder_(coder),
        models_(models),
        palette_(palette),
        dropped_(header.dropped),
        pattern_(header.pattern) {}

  const Coder& coder() const { return coder_; }

  // Codes an attribute, given those around.
  std::uint32_t code(const Neighbors& near, std::uint32_t truth) {
    const std::uint32_t normal = codeNormal(near, truth >> 8);
    const std::uint32_t entry = palette_ > 1 ? codeEntry(near, normal, truth & 0xff) : 0;
    last_ = entry | normal << 8;
    return last_;
  }
  // True if the normal of the last one was new.
  bool wasNew() const { return was_new_; }

 private:
  std::uint32_t codeNormal(const Neighbors& near, std::uint32_t truth) {
    const std::uint32_t how_new = near.fresh == 0                ? 0
                                  : near.fresh * 4 <= near.count ? 1
                                  : near.fresh * 2 <= near.count ? 2
                                  : near.fresh < near.count      ? 3
                                                                 : 4;
    was_new_ = false;
    if (near.alike) {
      const std::uint32_t only = (near.count == 0 ? last_ : near.attribute[0]) >> 8;
      if (coder_.bit(models_.same[0][how_new][std::min(near.count, 7u)], only == truth)) return only;
      return codeOtherNormal(Ballot(0), near, how_new, false, truth);
    }
    // Where all normals are new, most will be.
    const bool told = how_new == 4;
    if (told && !coder_.bit(models_.known[5], !Coder::kDecodes && isListed(near, truth)))
      return codeNewNormal(near, truth);
    Ballot ballot(near.votes_cast);
    const bool decided = ballot.begin(
        near.count, [&](std::uint32_t i) { return near.attribute[i] >> 8; },
        [&](std::uint32_t i) { return near.votes[i]; });
    if (!decided) ballot.finish();
    const bool nearest = ballot.value[0] == near.attribute[0] >> 8;
    if (coder_.bit(models_.same[nearest][how_new][8 + ballot.share(0)], ballot.value[0] == truth))
      return ballot.value[0];
    if (decided) ballot.finish();
    const std::uint32_t context = ballot.share(1) + 4 * std::min(ballot.count, 5u) - 8;
    if (coder_.bit(models_.same[2][how_new][context], ballot.value[1] == truth)) return ballot.value[1];
    return codeOtherNormal(ballot, near, how_new, told, truth);
  }

  // For an encoder: whether a normal is among those around, or a recent one.
  bool isListed(const Neighbors& near, std::uint32_t normal) const {
    for (std::uint32_t i = 0; i < near.count; ++i)
      if (near.attribute[i] >> 8 == normal) return true;
    return std::find(recent_.begin(), recent_.end(), normal) != recent_.end();
  }

  // One that is further down on the ballot, then the recent ones; or new. told: it is not new.
  std::uint32_t codeOtherNormal(const Ballot& ballot, const Neighbors& near, std::uint32_t how_new, bool told,
                                std::uint32_t truth) {
    std::uint32_t place = 2, index = 0;
    if (!Coder::kDecodes) {
      while (place < ballot.count && ballot.value[place] != truth) ++place;
      if (place >= ballot.count)
        while (index < kRecent && recent_[(newest_ + index) % kRecent] != truth) ++index;
    }
    if (!told && !coder_.bit(models_.known[how_new], place < ballot.count || index < kRecent))
      return codeNewNormal(near, truth);
    for (std::uint32_t i = 2; i < ballot.count; ++i)
      if (coder_.bit(models_.other[std::min(i - 2, 3u)], i == place)) return ballot.value[i];
    std::uint32_t node = 1;
    for (int bit = 3; bit >= 0; --bit)
      node = 2 * node + coder_.bit(models_.recent[node], (index >> bit & 1) != 0);
    return recent_[(newest_ + node) % kRecent];
  }

  std::uint32_t codeNewNormal(const Neighbors& near, std::uint32_t truth) {
    const std::uint32_t mask = 0xfffu >> dropped_;
    std::array<std::uint32_t, 2> least = {mask, mask}, most{}, sum{};
    for (std::uint32_t i = 0; i < near.count; ++i) {
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const std::uint32_t value = near.attribute[i] >> (8 + 12 * axis) >> dropped_ & mask;
        least[axis] = std::min(least[axis], value);
        most[axis] = std::max(most[axis], value);
        sum[axis] += value * near.votes[i];
      }
    }
    std::uint32_t normal = pattern_, before = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto shift = 12 * axis + dropped_;
      const std::uint32_t guess =
          near.count == 0 ? last_ >> (8 + shift) & mask
                          : static_cast<std::uint32_t>(
                                (std::uint64_t{sum[axis]} * kInverse[near.votes_cast] + (1u << 19)) >> 20);
      const auto spread = near.count == 0 ? 15u
                          : near.count == 1
                              ? 14u
                              : static_cast<std::uint32_t>(std::bit_width(most[axis] - least[axis]));
      std::uint32_t size = 0;
      const std::uint32_t difference =
          codeDifference(axis, spread, before / 2, (truth >> shift & mask) - guess, size);
      normal |= ((guess + difference) & mask) << shift;
      before = size;
    }
    was_new_ = true;
    newest_ = (newest_ + kRecent - 1) % kRecent;
    recent_[newest_] = normal;
    return normal;
  }

  // A difference, modulo 2^32, of less than 2^12 either way. size: its class.
  std::uint32_t codeDifference(std::size_t axis, std::uint32_t spread, std::uint32_t before,
                               std::uint32_t truth, std::uint32_t& size) {
    const bool truly_negative = truth >> 31 != 0;
    const std::uint32_t true_amount = truly_negative ? 0u - truth : truth;
    const auto true_size = static_cast<std::uint32_t>(std::bit_width(true_amount));
    std::array<Bit, kClasses>& tree = models_.size_of[axis][before][spread];
    std::uint32_t node = 1;
    for (int bit = 3; bit >= 0; --bit) node = 2 * node + coder_.bit(tree[node], (true_size >> bit & 1) != 0);
    size = node - kClasses;
    if (size == 0) return 0;
    const int left = static_cast<int>(size) - 1;
    const std::uint32_t rest =
        coder_.plain(left + 1, (true_amount & ((1u << left) - 1)) | std::uint32_t{truly_negative} << left);
    const std::uint32_t amount = 1u << left | (rest & ((1u << left) - 1));
    return rest >> left != 0 ? 0u - amount : amount;
  }

  std::uint32_t codeEntry(const Neighbors& near, std::uint32_t normal, std::uint32_t truth) {
    std::uint32_t alike = 0;
    for (std::uint32_t i = 0; i < near.count; ++i)
      alike += near.attribute[i] >> 8 == normal ? near.votes[i] : 0;
    Ballot ballot(near.votes_cast + 3 * alike);
    if (near.count > 0)
      ballot.begin(
          near.count, [&](std::uint32_t i) { return near.attribute[i] & 0xff; },
          [&](std::uint32_t i) {
            return near.attribute[i] >> 8 == normal ? 4 * near.votes[i] : near.votes[i];
          });
    else
      ballot.begin(
          1, [&](std::uint32_t) { return last_ & 0xff; }, [](std::uint32_t) { return 0u; });
    ballot.finish();
    for (std::uint32_t i = 0; i < ballot.count; ++i) {
      const std::uint32_t context = ballot.count == 1 ? std::min(near.count, 7u) : 8 + ballot.share(i);
      if (coder_.bit(models_.entry_same[std::min(i, 2u)][context], ballot.value[i] == truth))
        return ballot.value[i];
    }
    std::uint32_t node = 1;
    for (int bit = 7; bit >= 0; --bit)
      node = 2 * node + coder_.bit(models_.entry[node], (truth >> bit & 1) != 0);
    return node & 0xff;
  }

  Coder coder_;
  Models& models_;
  std::uint32_t palette_;
  std::uint32_t dropped_;
  std::uint32_t pattern_;
  std::uint32_t last_ = 2047u << 8 | 2047u << 20;
  std::uint32_t newest_ = 0;
  bool was_new_ = false;
  std::array<std::uint32_t, kRecent> recent_{};
};

// Codes all attributes of the page: one a surface voxel. False: an index is beyond the palette.
template <class Coder>
bool codeAttributes(Coder& shared, const PageHeader& header, const PageShape& shape, PageState& state,
                    std::span<std::conditional_t<Coder::kDecodes, std::uint32_t, const std::uint32_t>> all) {
  AttributeCoder<Coder> coder(shared, header, shape.palette, state.models);
  CodedWindow window;
  Neighbors near;
  std::size_t next = 0;
  for (std::size_t b = 0; b < shape.bricks.size(); ++b) {
    window.start(state, b, all);
    for (std::size_t z = 0; z < 8; ++z) {
      for (std::uint64_t left = state.surface[b][z]; left != 0; left &= left - 1) {
        const auto at = static_cast<std::size_t>(std::countr_zero(left)), x = at & 7, y = at >> 3;
        window.find(x, y, z, near);
        const std::uint32_t attribute = coder.code(near, Coder::kDecodes ? 0 : all[next]);
        if ((attribute & 0xff) >= shape.palette) return false;
        if constexpr (Coder::kDecodes) all[next] = attribute;
        window.set(x, y, z, attribute, coder.wasNew());
        state.fresh[next] = coder.wasNew();
        state.index[b][at + 64 * z] = static_cast<std::uint16_t>(next++);
      }
    }
  }
  shared = coder.coder();
  return true;
}

}  // namespace kelp::coding
