#pragma once
#include <Eigen/Core>
#include <vector>

namespace radiafit {

/// A symmetric matrix shaped like an arrow: unknowns in blocks that meet one another only through the last ones, the
/// corner's. J^T J of a light field map's vertex is one: its surface maps are blocks, its view map is the corner.
struct ArrowMatrix {
    std::vector<Eigen::MatrixXd> blocks;   ///< [block][n_b][n_b]
    std::vector<Eigen::MatrixXd> borders;  ///< [block][n_b][corner]
    Eigen::MatrixXd corner;
    /// All zero. sizes: of the blocks.
    ArrowMatrix(const std::vector<Eigen::Index>& sizes, Eigen::Index corner);
    /// this + factor times the other, of the same shape.
    ArrowMatrix& add(const ArrowMatrix& other, double factor = 1);
    /// Sum over all entries of this times the other's, both triangles: the trace of their product. `sparse` has entries
    /// within this shape.
    double product_trace(const ArrowMatrix& sparse) const;
};

/// The inverse of an arrow-shaped matrix, by elimination of its blocks (the Schur complement; Björck, Numerical Methods
/// for Least Squares Problems, 1996, section 6.3), over all changes whose part in the corner is orthogonal to some held
/// directions: a gauge that is fixed. Its entries outside the arrow are never formed.
class ArrowInverse {
public:
    /// held: [corner][any number] directions of the corner's unknowns, dependent ones among them or not. To every
    /// diagonal entry is added least_curvature times itself (1 where it is 0), so that directions without curvature
    /// have a huge variance, but a finite one.
    ArrowInverse(ArrowMatrix matrix, const Eigen::MatrixXd& held);

    const ArrowMatrix& matrix() const { return matrix_; }  ///< what is inverted: with what was added
    int deficient() const { return deficient_; }           ///< directions without curvature, held ones not among them
    ArrowMatrix inverse() const;
    /// inverse * m * inverse
    ArrowMatrix around(const ArrowMatrix& m) const;

private:
    ArrowMatrix matrix_;
    std::vector<Eigen::MatrixXd> block_inverses_;  ///< of the blocks alone
    std::vector<Eigen::MatrixXd> follow_;          ///< [block][n_b][corner]: how a block's optimum follows the corner
    Eigen::MatrixXd corner_inverse_;
    int deficient_ = 0;
};

}  // namespace radiafit
