// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <list>
#include <mutex>

namespace adit {

/// The most memory that this process held since restart_peak. Linux keeps it and starts it anew on request (proc(5),
/// clear_refs).
double peak_gib();
void restart_peak();
/// What the machine has left.
double available_gib();

/// The peaks of tasks that overlap in time: each is told the most that the whole process held while it ran.
class PeakShares {
 public:
  class Share {
   public:
    explicit Share(PeakShares& all);
    ~Share();
    Share(const Share&) = delete;
    double peak_gib() const;

   private:
    PeakShares& all_;
    std::list<double>::iterator mine_;
  };
  /// Of all so far.
  double highest_gib() const;

 private:
  mutable std::mutex mutex_;
  mutable std::list<double> running_;
  mutable double highest_ = 0;

  void look() const;
};

}  // namespace adit
