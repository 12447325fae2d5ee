#include "microsim/powder/sparse_rank.h"

#include <dlfcn.h>
#include <malloc.h>
#include <SuiteSparseQR.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

namespace softgrain {

namespace {

constexpr std::size_t kAlignment = 64;

void* aligned(std::size_t bytes) {
  return std::aligned_alloc(kAlignment, (bytes + kAlignment - 1) / kAlignment * kAlignment);
}

void* aligned_zeros(std::size_t count, std::size_t size) {
  void* const memory = aligned(count * size);
  return memory == nullptr ? nullptr : std::memset(memory, 0, count * size);
}

void* aligned_again(void* old, std::size_t bytes) {
  void* const memory = aligned(bytes);
  if (memory == nullptr || old == nullptr) return memory;
  std::memcpy(memory, old, std::min(bytes, ::malloc_usable_size(old)));
  std::free(old);
  return memory;
}

/// Vector loops treat the first elements up to an aligned address apart, so that sums depend on where memory happens
/// to lie, which differs from thread to thread: the library gets aligned memory only.
void align_memory() {
#if SUITESPARSE_MAIN_VERSION >= 6  // Ubuntu 24.04, Debian 13; Debian 12 has version 5
  SuiteSparse_config_malloc_func_set(aligned);
  SuiteSparse_config_calloc_func_set(aligned_zeros);
  SuiteSparse_config_realloc_func_set(aligned_again);
#else
  SuiteSparse_config.malloc_func = aligned;
  SuiteSparse_config.calloc_func = aligned_zeros;
  SuiteSparse_config.realloc_func = aligned_again;
#endif
}

/// A BLAS with threads of its own splits its sums by how many of them are free at the moment, and the last bits follow.
/// OpenBLAS is asked to work alone where it is the one in use; samples share the threads of the program anyway.
void one_thread_for_blas() {
  static const bool asked = [] {
    auto* const set = reinterpret_cast<void (*)(int)>(::dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
    if (set != nullptr) set(1);
    align_memory();
    return set != nullptr;
  }();
  (void)asked;
}

/// The workspace of CHOLMOD and what was made with it, freed together.
class Workspace {
 public:
  Workspace() {
    one_thread_for_blas();
    cholmod_l_start(&common_);
    common_.print = 0;
  }
  ~Workspace() {
    cholmod_l_free_triplet(&list, &common_);
    cholmod_l_free_sparse(&matrix, &common_);
    cholmod_l_free_sparse(&r, &common_);
    if (order != nullptr) cholmod_l_free(columns, sizeof(SuiteSparse_long), order, &common_);
    cholmod_l_finish(&common_);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  cholmod_common* common() { return &common_; }
  void check() const {
    if (common_.status < CHOLMOD_OK) throw std::runtime_error("QR of a sparse matrix failed");
  }

  cholmod_triplet* list = nullptr;
  cholmod_sparse* matrix = nullptr;
  cholmod_sparse* r = nullptr;
  SuiteSparse_long* order = nullptr;  ///< null: none
  std::size_t columns = 0;

 private:
  cholmod_common common_{};
};

void load(const SparseEntries& m, Workspace& work) {
  work.columns = static_cast<std::size_t>(m.columns);
  work.list = cholmod_l_allocate_triplet(static_cast<std::size_t>(m.rows), work.columns, m.entries.size(), 0,
                                         CHOLMOD_REAL, work.common());
  work.check();
  for (std::size_t k = 0; k < m.entries.size(); ++k) {
    static_cast<SuiteSparse_long*>(work.list->i)[k] = m.entries[k].row;
    static_cast<SuiteSparse_long*>(work.list->j)[k] = m.entries[k].column;
    static_cast<double*>(work.list->x)[k] = m.entries[k].value;
  }
  work.list->nnz = m.entries.size();
  work.matrix = cholmod_l_triplet_to_sparse(work.list, m.entries.size(), work.common());
  work.check();
}

/// R has its independent columns first.
TriangularFactor leading(const Workspace& work, std::int64_t rank) {
  TriangularFactor out;
  out.rank = rank;
  const auto* start = static_cast<const SuiteSparse_long*>(work.r->p);
  const auto* row = static_cast<const SuiteSparse_long*>(work.r->i);
  const auto* value = static_cast<const double*>(work.r->x);
  out.start.assign(start, start + rank + 1);
  out.row.assign(row, row + start[rank]);
  out.value.assign(value, value + start[rank]);
  for (std::int64_t c = 0; c < rank; ++c) {
    out.column_of.push_back(work.order == nullptr ? c : work.order[c]);
    if (start[c + 1] == start[c] || row[start[c + 1] - 1] != c)
      throw std::runtime_error("QR of a sparse matrix: R is not triangular");
  }
  return out;
}

}  // namespace

void TriangularFactor::solve_normal(std::vector<double>& x) const {
  const auto first = [&](std::int64_t c) { return static_cast<std::size_t>(start[static_cast<std::size_t>(c)]); };
  for (std::int64_t c = 0; c < rank; ++c) {
    const std::size_t diagonal = first(c + 1) - 1;
    double sum = x[static_cast<std::size_t>(c)];
    for (std::size_t k = first(c); k < diagonal; ++k) sum -= value[k] * x[static_cast<std::size_t>(row[k])];
    x[static_cast<std::size_t>(c)] = sum / value[diagonal];
  }
  for (std::int64_t c = rank - 1; c >= 0; --c) {
    const std::size_t diagonal = first(c + 1) - 1;
    const double solved = x[static_cast<std::size_t>(c)] /= value[diagonal];
    for (std::size_t k = first(c); k < diagonal; ++k) x[static_cast<std::size_t>(row[k])] -= value[k] * solved;
  }
}

TriangularFactor sparse_qr(const SparseEntries& matrix, double tolerance) {
  Workspace work;
  load(matrix, work);
  constexpr SuiteSparse_long kNoMoreRows = 0;  // of R than the rank
  const std::int64_t rank = SuiteSparseQR<double>(SPQR_ORDERING_DEFAULT, tolerance, kNoMoreRows, work.matrix, &work.r,
                                                  &work.order, work.common());
  work.check();
  TriangularFactor out = leading(work, rank);
  out.dropped = work.common()->SPQR_norm_E_fro;
  return out;
}

namespace {

using Entry = SparseEntries::Entry;

void to_unit_length(SparseEntries& matrix, std::int64_t Entry::*line, std::int64_t lines) {
  std::vector<double> square(static_cast<std::size_t>(lines), 0.0);
  for (const Entry& e : matrix.entries) square[static_cast<std::size_t>(e.*line)] += e.value * e.value;
  for (Entry& e : matrix.entries) e.value /= std::sqrt(square[static_cast<std::size_t>(e.*line)]);
}

struct SingularPair {
  double value = 0.0;
  std::vector<double> vector;
};

/// Smallest singular value of R by inverse iteration on R^T R: from above, at once when it is far below the others.
SingularPair smallest_singular(const TriangularFactor& factor) {
  constexpr int kIterations = 20;
  SingularPair out;
  for (std::int64_t k = 0; k < factor.rank; ++k) out.vector.push_back(std::sin(static_cast<double>(k) + 1.0));
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    double square = 0.0;
    for (const double x : out.vector) square += x * x;
    const double size = std::sqrt(square);
    for (double& x : out.vector) x /= size;
    if (iteration > 0) out.value = 1.0 / std::sqrt(size);
    if (iteration < kIterations) factor.solve_normal(out.vector);
  }
  return out;
}

void take_out(SparseEntries& matrix, std::int64_t column) {
  std::erase_if(matrix.entries, [&](const Entry& e) { return e.column == column; });
}

}  // namespace

SparseRank sparse_rank(const SparseEntries& matrix) {
  SparseEntries scaled = matrix;
  to_unit_length(scaled, &Entry::row, matrix.rows);
  to_unit_length(scaled, &Entry::column, matrix.columns);
  SparseRank out;
  while (!scaled.entries.empty()) {
    const TriangularFactor factor = sparse_qr(scaled, kRankTolerance);
    const SingularPair smallest = smallest_singular(factor);
    ++out.factorisations;
    out.rank = factor.rank;
    out.smallest_kept = smallest.value;
    out.largest_dropped = std::max(out.largest_dropped, factor.dropped);
    if (smallest.value >= kRankTolerance) break;
    out.largest_dropped = std::max(out.largest_dropped, smallest.value);
    const auto most = std::max_element(smallest.vector.begin(), smallest.vector.end(),
                                       [](double a, double b) { return std::abs(a) < std::abs(b); });
    take_out(scaled, factor.column_of[static_cast<std::size_t>(most - smallest.vector.begin())]);
  }
  return out;
}

}  // namespace softgrain
