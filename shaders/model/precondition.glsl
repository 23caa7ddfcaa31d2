// An entry of the preconditioner P from diag(J'J) / S-bar, the penalties' part included: not below 1e-4 of the problem's
// largest, and `least` more than nothing. The includer says what an element is. C++: model/penalty.h.
SHARED_FN element preconditioner(element entry, element largest, element least) {
    return max(real(1.0e-4) * largest + least, entry);
}
