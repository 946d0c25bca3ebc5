"""Programs that write pages of the documents and the references of the hard cases; tests hold the pages to them."""
